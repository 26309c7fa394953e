"""Stops for a broken sensor during a scripted lesson."""

from enum import Enum

from kurt2rt.core.decision.standing import ActiveStop, StopReason


class SensorStopAct(Enum):
    """Act by which a person frees a robot that stopped for a broken sensor, in a simulated lesson."""

    CARRY_AWAY = "carry_away"
    RESUME = "resume"


class SensorStopTimer:
    """Times at which a robot that stopped for a broken sensor is carried away, and sent on.

    All sensors of a lesson work. A resume trusts a sensor again only if its reading has changed (hal.sensor_watch). So
    after a false alarm the robot is carried away after a second, and sent on after another.
    """

    def __init__(self, ticks_per_second: int) -> None:
        self._ticks_per_second = ticks_per_second
        self._ticks = 0

    def update(self, stop: ActiveStop | None) -> SensorStopAct | None:
        """Return the act that is due in this tick, if any; call it in every tick with the robot's active stop."""
        if stop is None or stop.reason is not StopReason.SENSOR_BROKEN:
            self._ticks = 0
            return None
        self._ticks += 1
        if self._ticks == self._ticks_per_second:
            return SensorStopAct.CARRY_AWAY
        return SensorStopAct.RESUME if self._ticks == 2 * self._ticks_per_second else None
