"""Choice of the place where a simulated robot without progress is put."""

import math
import random
from collections import deque

from hal.simulation import SimulatedPlace
from kurt2rt.channel.protocol.state import State

_MAX_PLACES = 50


class RobotRepositioner:
    """Places that the robot drove through, and the detection that it has stayed about one place for too long."""

    def __init__(self, after_s: float, least_m: float, period_s: float, chance: random.Random) -> None:
        """Reposition a robot that moved at most `least_m` in `after_s`, longer in a slow lesson.

        `period_s` is the length of a tick.
        """
        self._after_ticks = round(after_s / period_s)
        self._least_m = least_m
        self._chance = chance
        self._passed: deque[SimulatedPlace] = deque(maxlen=_MAX_PLACES)
        self._from: SimulatedPlace | None = None
        self._since = 0
        self._clean = True
        """Without a collision since `_from`."""

    def update(self, state: State, *, waits: bool) -> SimulatedPlace | None:
        """Process a state; return the place to put the robot now, if it made no progress; None if it shall stay.

        Time in which the robot `waits` for its teacher does not count. A place counts as passed if the robot came there
        without a collision.
        """
        place = state.place
        if place is None:
            return None
        if self._from is None:
            if not self._passed:  # after a repositioning, this state may still show the place where it was stuck
                self._passed.append(place)
            self._begin(place, state.tick)
            return None
        self._clean = self._clean and place.collisions == self._from.collisions
        if _distance_m(place, self._from) > self._least_m:
            if self._clean:
                self._passed.append(place)
            self._begin(place, state.tick)
        elif waits:
            self._begin(place, state.tick)
        elif (state.tick - self._since) * state.speed_share >= self._after_ticks:
            self._from = None  # the next state gives the new start
            return self._choose(place)
        return None

    def _begin(self, place: SimulatedPlace, tick: int) -> None:
        self._from, self._since, self._clean = place, tick, True

    def _choose(self, here: SimulatedPlace) -> SimulatedPlace:
        places = [each for each in self._passed if _distance_m(each, here) > self._least_m]
        return self._chance.choice(places or list(self._passed))


def _distance_m(one: SimulatedPlace, other: SimulatedPlace) -> float:
    return math.hypot(one.x_m - other.x_m, one.y_m - other.y_m)
