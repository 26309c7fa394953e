"""Where the robot is and how it turns, low-passed and with hysteresis: street, crossing, left, right."""

from typing import Annotated

from pydantic import Field

from kurt2rt.core.decision.decision import Decision
from kurt2rt.core.decision.junction_event import JunctionEvent
from kurt2rt.core.mid.junction_detector import JunctionDetector
from kurt2rt.core.mid.symbols.source import NONE, SymbolSettings, SymbolSource, Transitions

Metres = Annotated[float, Field(gt=0, le=10)]
Radians = Annotated[float, Field(gt=0, le=10)]

_STREET, _CROSSING, _LEFT, _RIGHT = range(1, 5)


class TurnsSettings(SymbolSettings):
    """Way is that of the wheels' rims, the mean of both sides, so a robot that turns on the spot makes way, too."""

    smooth_over_m: Metres
    """Over so much way a turn is forgotten."""
    turning_rad: Radians
    """A robot that has turned so far lately is turning."""
    straight_rad: Radians
    """One that was turning, and has turned less than this lately, is not any more."""
    crossing_over_m: Metres
    """Over so much way a side must be open for a crossing."""
    street_over_m: Metres
    """Over so much way walls must stand on both sides for a street."""

    @property
    def names(self) -> tuple[str, ...]:
        """What a robot does in streets."""
        return ("street", "crossing", "left", "right")

    def build(self, transitions: Transitions) -> SymbolSource:  # noqa: ARG002 - it goes by nothing learned
        """The source."""
        return Turns(self)


class Turns:
    """One symbol each time it becomes another one.

    A crossing is told when it lies behind the robot without a turn: some turn at once where a side opens, some late.
    """

    def __init__(self, settings: TurnsSettings) -> None:
        self._settings = settings
        self.restart()

    def restart(self) -> None:
        """The robot has not turned, and where it is has to show."""
        self._turned_rad = self._open_m = self._walled_m = 0.0
        self._in_crossing = False
        self._last = NONE

    def perceive(self, before: Decision, detector: JunctionDetector, passed: JunctionEvent | None) -> int:  # noqa: ARG002
        """What it has begun, or passed."""
        rims_m = detector.rims_m
        if rims_m == 0.0:
            return NONE
        self._turned_rad += detector.turn_rad
        self._turned_rad -= min(1.0, rims_m / self._settings.smooth_over_m) * self._turned_rad
        self._open_m = self._open_m + rims_m if detector.opened else 0.0
        self._walled_m = self._walled_m + rims_m if detector.walled else 0.0
        symbol = self._now()
        if symbol in (NONE, self._last):
            return NONE
        self._last = symbol
        return symbol

    def _now(self) -> int:
        """NONE: what it was before. A turn goes on until the robot is straight in a street again."""
        want = self._settings
        if abs(self._turned_rad) >= want.turning_rad:
            self._in_crossing = False
            return _LEFT if self._turned_rad > 0 else _RIGHT
        if self._open_m >= want.crossing_over_m and self._last == _STREET:
            self._in_crossing = True
        if self._walled_m < want.street_over_m or abs(self._turned_rad) >= want.straight_rad:
            return NONE
        if self._in_crossing:
            self._in_crossing = False
            return _CROSSING
        return _STREET
