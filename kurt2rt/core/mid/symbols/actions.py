"""Actions of the basic level's RLAs as symbols (paper, section VI.B.2)."""

from typing import Annotated

from pydantic import Field

from kurt2rt.core.decision.decision import Decision
from kurt2rt.core.decision.junction_event import JunctionEvent
from kurt2rt.core.mid.junction_detector import JunctionDetector
from kurt2rt.core.mid.symbols.source import NONE, SymbolSettings, SymbolSource, Transitions


class ActionsSettings(SymbolSettings):
    """Settings of actions as symbols."""

    actions: Annotated[tuple[str, ...], Field(min_length=1)]
    """Actions that are symbols; others are ignored."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the actions."""
        return self.actions

    def build(self, transitions: Transitions) -> SymbolSource:  # noqa: ARG002 - needs no counts
        """Return a source of actions without a last action; `transitions` are not used."""
        return ActionSymbols(self.actions)


class ActionSymbols:
    """Source of the driving action at each change; standstill is no change."""

    def __init__(self, actions: tuple[str, ...]) -> None:
        self._symbols = {action: number for number, action in enumerate(actions, start=1)}
        self._last = NONE

    def perceive(self, before: Decision, detector: JunctionDetector, passed: JunctionEvent | None) -> int:  # noqa: ARG002
        """Return the symbol of an action that began in the last tick; NONE without one.

        `before`: decision of the last tick. The other arguments are not used.
        """
        symbol = NONE if before.action is None else self._symbols.get(before.action, NONE)
        if symbol in (NONE, self._last):
            return NONE
        self._last = symbol
        return symbol

    def restart(self) -> None:
        """Forget the last action."""
        self._last = NONE
