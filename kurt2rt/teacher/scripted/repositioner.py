"""A hand that sets a simulated robot down elsewhere where it makes no way."""

import math
import random
from collections import deque

from hal.simulation import SimulatedPlace
from kurt2rt.channel.protocol.state import State

_MOST_PLACES = 50


class RobotRepositioner:
    """Notes where the robot came through, and puts it there again after it has stayed about one place for too long."""

    def __init__(self, after_s: float, least_m: float, period_s: float, chance: random.Random) -> None:
        """No way is made where the robot came no farther than `least_m` in `after_s`. `period_s`: of its ticks."""
        self._after_ticks = round(after_s / period_s)
        self._least_m = least_m
        self._chance = chance
        self._came_through: deque[SimulatedPlace] = deque(maxlen=_MOST_PLACES)
        self._from: SimulatedPlace | None = None
        self._since = 0
        self._clean = True
        """Whether it touched nothing since it was there."""

    def see(self, state: State, *, waits: bool) -> SimulatedPlace | None:
        """See a picture; where to set the robot down now, None: nowhere.

        Time in which it `waits` for somebody does not count. It came through a place where it had made way and touched
        nothing since the one before.
        """
        place = state.place
        if place is None:
            return None
        if self._from is None:
            if not self._came_through:  # a later one may show it still where it was stuck
                self._came_through.append(place)
            self._begin(place, state.tick)
            return None
        self._clean = self._clean and place.collisions == self._from.collisions
        if _apart_m(place, self._from) > self._least_m:
            if self._clean:
                self._came_through.append(place)
            self._begin(place, state.tick)
        elif waits:
            self._begin(place, state.tick)
        elif state.tick - self._since >= self._after_ticks:
            self._from = None  # begins anew where the next picture shows it
            return self._somewhere_else(place)
        return None

    def _begin(self, place: SimulatedPlace, tick: int) -> None:
        self._from, self._since, self._clean = place, tick, True

    def _somewhere_else(self, here: SimulatedPlace) -> SimulatedPlace:
        places = [each for each in self._came_through if _apart_m(each, here) > self._least_m]
        return self._chance.choice(places or list(self._came_through))


def _apart_m(one: SimulatedPlace, other: SimulatedPlace) -> float:
    return math.hypot(one.x_m - other.x_m, one.y_m - other.y_m)
