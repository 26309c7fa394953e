"""Turns at passed junctions as symbols, one per junction."""

from kurt2rt.core.decision.decision import Decision
from kurt2rt.core.decision.junction_event import NAMES, JunctionEvent
from kurt2rt.core.mid.junction_detector import JunctionDetector
from kurt2rt.core.mid.symbols.source import NONE, SymbolSettings, SymbolSource, Transitions

_SYMBOLS = {quarters: number for number, quarters in enumerate(NAMES, start=1)}


class JunctionsSettings(SymbolSettings):
    """Settings of junctions as symbols; equal ones in a row count too."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the turns at a junction."""
        return tuple(NAMES.values())

    def build(self, transitions: Transitions) -> SymbolSource:  # noqa: ARG002 - needs no counts
        """Return a source of the turns at junctions; `transitions` are not used."""
        return JunctionSymbols()


class JunctionSymbols:
    """Source of the turn at each passed junction."""

    def perceive(self, before: Decision, detector: JunctionDetector, passed: JunctionEvent | None) -> int:  # noqa: ARG002
        """Return the symbol of `passed`, the junction passed in this tick; NONE without one."""
        return NONE if passed is None else _SYMBOLS[passed.quarters]

    def restart(self) -> None:
        """Do nothing: there is no state."""
