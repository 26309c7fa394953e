"""Somebody who looks after the robot itself: picks it up where it is stuck."""

import math

from kurt2rt.layers.decision import Cause
from kurt2rt.soak.place import SoakPlace
from kurt2rt.tick import TickRecord

_WAY_M = 0.3


class Person:
    """Sets the robot down elsewhere when it has been about where it is for too long though it would drive."""

    def __init__(self, place: SoakPlace, after_s: float, period_s: float) -> None:
        self.set_down = 0
        """How often."""
        self._place = place
        self._most_ticks = round(after_s / period_s)
        self._ticks = 0
        self._from_m = place.position_m

    def sees(self, record: TickRecord) -> bool:
        """See a tick; True where the robot was picked up after it."""
        if record.decision.cause not in (Cause.RLA, Cause.HELD, Cause.TEACHER):
            return False
        here_m = self._place.position_m
        if math.dist(here_m, self._from_m) > _WAY_M:
            self._from_m, self._ticks = here_m, 0
            return False
        self._ticks += 1
        if self._ticks < self._most_ticks:
            return False
        self._place.set_down()
        self._from_m, self._ticks = self._place.position_m, 0
        self.set_down += 1
        return True
