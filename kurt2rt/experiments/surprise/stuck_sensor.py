"""Robot with one infrared sensor that is stuck at a constant count."""

from hal.robot import Robot, SensorReadings
from hal.robot_proxy import RobotProxy


class StuckSensor(RobotProxy):
    """Proxy of a robot that freezes one of its infrared sensors."""

    def __init__(self, robot: Robot, sensor: int, from_s: float) -> None:
        """`sensor`: index in the robot's sensor table; stuck from `from_s` of the runtime's clock on."""
        super().__init__(robot)
        self._sensor = sensor
        self._from_s = from_s
        self._counts: int | None = None

    def sense(self, now_s: float) -> SensorReadings:
        """Return the robot's readings, with the stuck sensor at its count of `from_s`."""
        readings = self._robot.sense(now_s)
        if now_s < self._from_s:
            return readings
        counts = readings.infrared_counts
        if self._counts is None:
            self._counts = counts[self._sensor]
        stuck = (*counts[: self._sensor], self._counts, *counts[self._sensor + 1 :])
        return readings._replace(infrared_counts=stuck)
