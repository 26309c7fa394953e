"""Street, crossing and turns as symbols, low-pass filtered and with hysteresis."""

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
    """Settings of turns as symbols; distance is the mean of both wheels, so turning on the spot adds distance."""

    smooth_over_m: Metres
    """Distance constant of the turn filter."""
    turning_rad: Radians
    """Filtered angle at which a turn begins."""
    straight_rad: Radians
    """Filtered angle below which a turn has ended."""
    crossing_over_m: Metres
    """Distance with an open side that makes a crossing."""
    street_over_m: Metres
    """Distance between two walls that makes a street."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the symbols, from symbol 1 on."""
        return ("street", "crossing", "left", "right")

    def build(self, transitions: Transitions) -> SymbolSource:  # noqa: ARG002 - needs no counts
        """Return a source of turns without a last symbol; `transitions` are not used."""
        return TurnSymbols(self)


class TurnSymbols:
    """Source of a symbol at each change.

    A crossing counts after the robot has passed it without a turn, because turns begin early or late in it.
    """

    def __init__(self, settings: TurnsSettings) -> None:
        self._settings = settings
        self.restart()

    def restart(self) -> None:
        """Reset the filters and the last symbol."""
        self._turned_rad = self._open_m = self._walled_m = 0.0
        self._in_crossing = False
        self._last = NONE

    def perceive(self, before: Decision, detector: JunctionDetector, passed: JunctionEvent | None) -> int:  # noqa: ARG002
        """Return the symbol that has just begun, or the passed crossing; NONE without a change.

        `detector`: has processed this tick. The other arguments are not used.
        """
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
        """Return the present symbol, NONE for no change; a turn lasts until the robot is straight in a street."""
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
