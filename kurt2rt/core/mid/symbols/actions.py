"""The paper's plain reading: the actions that the basic level's RLAs took (VI.B.2)."""

from typing import Annotated

from pydantic import Field

from kurt2rt.core.decision.decision import Decision
from kurt2rt.core.decision.junction_event import JunctionEvent
from kurt2rt.core.mid.junction_detector import JunctionDetector
from kurt2rt.core.mid.symbols.source import NONE, SymbolSettings, SymbolSource, Transitions


class ActionsSettings(SymbolSettings):
    """Actions of the repertoire."""

    actions: Annotated[tuple[str, ...], Field(min_length=1)]
    """Those that make symbols; any other one makes none."""

    @property
    def names(self) -> tuple[str, ...]:
        """The actions."""
        return self.actions

    def build(self, transitions: Transitions) -> SymbolSource:  # noqa: ARG002 - it goes by nothing learned
        """The source."""
        return Actions(self.actions)


class Actions:
    """The action that drives, each time it becomes another one. A robot that stands has none, and forgets none."""

    def __init__(self, actions: tuple[str, ...]) -> None:
        self._symbols = {action: number for number, action in enumerate(actions, start=1)}
        self._last = NONE

    def perceive(self, before: Decision, detector: JunctionDetector, passed: JunctionEvent | None) -> int:  # noqa: ARG002
        """The symbol of the action that began to drive in the tick before."""
        symbol = NONE if before.action is None else self._symbols.get(before.action, NONE)
        if symbol in (NONE, self._last):
            return NONE
        self._last = symbol
        return symbol

    def restart(self) -> None:
        """Whatever drives next is new."""
        self._last = NONE
