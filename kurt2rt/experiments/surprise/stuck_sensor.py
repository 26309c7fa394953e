"""A robot of which one infra-red sensor goes on telling what it told once."""

from hal.robot import Robot, SensorReadings
from hal.robot_proxy import RobotProxy


class StuckSensor(RobotProxy):
    """Another robot, its senses but for one."""

    def __init__(self, robot: Robot, sensor: int, from_s: float) -> None:
        """`sensor`: its place in the robot's table; it is stuck from `from_s` of the runtime's clock on."""
        super().__init__(robot)
        self._sensor = sensor
        self._from_s = from_s
        self._counts: int | None = None

    def sense(self, now_s: float) -> SensorReadings:
        """What the robot senses, and of the stuck sensor what it sensed when it got stuck."""
        senses = self._robot.sense(now_s)
        if now_s < self._from_s:
            return senses
        readings = senses.infrared_counts
        if self._counts is None:
            self._counts = readings[self._sensor]
        stuck = (*readings[: self._sensor], self._counts, *readings[self._sensor + 1 :])
        return senses._replace(infrared_counts=stuck)
