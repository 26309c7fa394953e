"""A robot of which one infra-red sensor goes on telling what it told once."""

from hal.robot import Grant, Robot, Senses, WheelSpeeds


class StuckSensor:
    """Another robot (hal.robot.Robot), its senses but for one."""

    def __init__(self, robot: Robot, sensor: int, from_s: float) -> None:
        """`sensor`: its place in the robot's table; it is stuck from `from_s` of the runtime's clock on."""
        self._robot = robot
        self._sensor = sensor
        self._from_s = from_s
        self._counts: int | None = None

    def sense(self, now_s: float) -> Senses:
        """What the robot senses, and of the stuck sensor what it sensed when it got stuck."""
        senses = self._robot.sense(now_s)
        if now_s < self._from_s:
            return senses
        readings = senses.infrared_counts
        if self._counts is None:
            self._counts = readings[self._sensor]
        stuck = (*readings[: self._sensor], self._counts, *readings[self._sensor + 1 :])
        return senses._replace(infrared_counts=stuck)

    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> Grant:
        """As the robot."""
        return self._robot.drive(wanted, decided_at_s, now_s)

    def emergency_stop(self, reason: str) -> None:
        """As the robot."""
        self._robot.emergency_stop(reason)

    def release(self) -> None:
        """As the robot."""
        self._robot.release()

    def close(self) -> None:
        """As the robot."""
        self._robot.close()
