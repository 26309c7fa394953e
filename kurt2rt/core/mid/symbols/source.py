"""Protocol of a source of symbols, and base of its settings."""

from abc import abstractmethod
from collections.abc import Mapping
from typing import Annotated, Protocol

from pydantic import PlainValidator, SerializeAsAny

from hal.settings_by_kind import KindSettings, as_its_kind
from kurt2rt.core.decision.decision import Decision
from kurt2rt.core.decision.junction_event import JunctionEvent
from kurt2rt.core.mid.junction_detector import JunctionDetector

Transitions = Mapping[tuple[int, int], int]
"""(RLA id, follow-up RLA id) -> number of transitions so far."""

NONE = 0
"""Symbol of an unused place of a history."""


class SymbolSource(Protocol):
    """Source of the new symbol of each tick."""

    def perceive(self, before: Decision, detector: JunctionDetector, passed: JunctionEvent | None) -> int:
        """Return the new symbol of this tick; NONE without one.

        `before`: decision of the last tick; `passed`: result of `detector` in this tick.
        """
        ...

    def restart(self) -> None:
        """Reset after power-on or repositioning."""
        ...


class SymbolSettings(KindSettings):
    """Base of the settings of symbols; the class is named after its file, the kind."""

    @property
    @abstractmethod
    def names(self) -> tuple[str, ...]:
        """Names of the symbols from 1; empty if the symbols are RLA ids."""

    @abstractmethod
    def build(self, transitions: Transitions) -> SymbolSource:
        """Return the source; `transitions`: (RLA id, follow-up id) -> count so far, of all levels."""


def _checked(given: object) -> SymbolSettings:
    return as_its_kind(given, "kurt2rt.core.mid.symbols", SymbolSettings)  # type: ignore[type-abstract]


AnySymbolSettings = Annotated[SerializeAsAny[SymbolSettings], PlainValidator(_checked)]
"""Schema type: settings of the kind that a file names."""
