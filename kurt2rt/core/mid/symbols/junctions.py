"""One symbol per junction that was passed: what the robot did there."""

from kurt2rt.core.decision.decision import Decision
from kurt2rt.core.decision.junction_event import NAMES, JunctionEvent
from kurt2rt.core.mid.junction_detector import JunctionDetector
from kurt2rt.core.mid.symbols.source import NONE, SymbolSettings, SymbolSource, Transitions

_SYMBOLS = {quarters: number for number, quarters in enumerate(NAMES, start=1)}


class JunctionsSettings(SymbolSettings):
    """Junctions are events: all count, equal ones too."""

    @property
    def names(self) -> tuple[str, ...]:
        """What can be done at a junction."""
        return tuple(NAMES.values())

    def build(self, transitions: Transitions) -> SymbolSource:  # noqa: ARG002 - it goes by nothing learned
        """The source."""
        return Junctions()


class Junctions:
    """Symbols of the junctions that are passed."""

    def perceive(self, before: Decision, detector: JunctionDetector, passed: JunctionEvent | None) -> int:  # noqa: ARG002
        """The symbol of the junction that was passed in this tick."""
        return NONE if passed is None else _SYMBOLS[passed.quarters]

    def restart(self) -> None:
        """There is nothing to forget."""
