"""One symbol per junction that was passed: what the robot did there."""

from hal.robot import Senses
from hal.robot_settings import RobotSettings
from kurt2rt.layers.decision import Decision
from kurt2rt.mid.junction_event import JunctionEvent
from kurt2rt.mid.symbols.source import NONE, SymbolSettings, SymbolSource

_SYMBOLS = {0: 1, 1: 2, -1: 3, 2: 4}
"""By quarter turns to the left."""


class JunctionsSettings(SymbolSettings):
    """Straight, left, right, back. Junctions are events, so all count, equal ones too."""

    @property
    def names(self) -> tuple[str, ...]:
        """What can be done at a junction."""
        return ("straight", "left", "right", "back")

    def build(self, robot: RobotSettings) -> SymbolSource:  # noqa: ARG002 - the junctions were found already
        """The source."""
        return Junctions()


class Junctions:
    """Symbols of the junctions that are passed."""

    def perceive(self, senses: Senses, before: Decision, passed: JunctionEvent | None) -> int:  # noqa: ARG002
        """The symbol of the junction that was passed in this tick."""
        return NONE if passed is None else _SYMBOLS[passed.quarters]

    def restart(self) -> None:
        """There is nothing to forget."""
