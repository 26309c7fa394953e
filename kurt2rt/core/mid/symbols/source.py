"""The contract of a source of symbols."""

from abc import abstractmethod
from collections.abc import Mapping
from typing import Annotated, Protocol

from pydantic import PlainValidator, SerializeAsAny

from hal.settings_by_kind import KindSettings, as_its_kind
from kurt2rt.core.decision.decision import Decision
from kurt2rt.core.decision.junction_event import JunctionEvent
from kurt2rt.core.mid.junction_detector import JunctionDetector

Transitions = Mapping[tuple[int, int], int]
"""(RLA id, follow-up RLA id) -> how often the one followed the other, as counted up to now."""

NONE = 0
"""The symbol of a place of a history that nothing stands in yet."""


class SymbolSource(Protocol):
    """Says in each tick which symbol is to be remembered."""

    def perceive(self, before: Decision, detector: JunctionDetector, passed: JunctionEvent | None) -> int:
        """The symbol that is new in this tick; NONE: none is.

        `before`: the decision of the tick before; `detector` has seen this tick, and `passed` is what it said.
        """
        ...

    def restart(self) -> None:
        """Forget what was."""
        ...


class SymbolSettings(KindSettings):
    """Base of the settings of every kind of symbols: a class named after its file in this folder, which is the kind."""

    @property
    @abstractmethod
    def names(self) -> tuple[str, ...]:
        """How the symbols 1, 2, 3 ... are spoken of; empty where they are numbers of RLAs."""

    @abstractmethod
    def build(self, transitions: Transitions) -> SymbolSource:
        """The source. `transitions`: of the basic level's RLAs, among others."""


def _checked(given: object) -> SymbolSettings:
    return as_its_kind(given, "kurt2rt.core.mid.symbols", SymbolSettings)  # type: ignore[type-abstract]


AnySymbolSettings = Annotated[SerializeAsAny[SymbolSettings], PlainValidator(_checked)]
"""In a schema: settings of whatever kind of symbols the file names."""
