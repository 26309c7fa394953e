"""Distances in metres from infra-red counts."""

from collections.abc import Callable
from operator import itemgetter
from typing import Annotated

from pydantic import Field

from hal.robot import HIGHEST_COUNTS
from hal.robot_settings import InfraredSettings

Look = Callable[[tuple[int, ...]], tuple[float, ...]]

Distance = Annotated[float, Field(ge=0.05, le=0.6)]
"""Distance in metres within the sensors' range."""

LEFT_FRONT_TO_BACK = ("s1", "s3", "s4", "s2")
RIGHT_FRONT_TO_BACK = ("s5", "s7", "s8", "s6")
FRONT = ("s9", "s11", "s10")
REAR = ("s12", "s14", "s13")
FRONT_LEFT_EDGE, FRONT_RIGHT_EDGE, REAR_LEFT_EDGE, REAR_RIGHT_EDGE = "s15", "s16", "s17", "s18"
LEFT_WITH_EDGES = (FRONT_LEFT_EDGE, *LEFT_FRONT_TO_BACK, REAR_LEFT_EDGE)
RIGHT_WITH_EDGES = (FRONT_RIGHT_EDGE, *RIGHT_FRONT_TO_BACK, REAR_RIGHT_EDGE)


class Distances:
    """Lookup table from counts to distances from the sensors' faces."""

    def __init__(self, infrared: InfraredSettings) -> None:
        # A table, because a teacher asks in every tick of a lesson.
        self._distance_m = tuple(infrared.distance_m(counts) for counts in range(HIGHEST_COUNTS + 1))
        self._index = {name: index for index, name in enumerate(infrared.names)}
        self._x_m = {name: sensor.x_m for name, sensor in zip(infrared.names, infrared.sensors, strict=True)}

    def of(self, *names: str) -> Look:
        """Return a function from counts of all sensors to the distances in m of the named ones, in their order.

        Raises KeyError for an unknown sensor.
        """
        distance_m = self._distance_m
        if len(names) == 1:  # a getter of one place returns no tuple
            place = self._index[names[0]]
            return lambda counts: (distance_m[counts[place]],)
        at, seen = distance_m.__getitem__, itemgetter(*(self._index[name] for name in names))
        return lambda counts: tuple(map(at, seen(counts)))

    def ahead_m(self, *names: str) -> tuple[float, ...]:
        """Return the positions of the named sensors ahead of the robot's centre, in m. Raises KeyError."""
        return tuple(self._x_m[name] for name in names)
