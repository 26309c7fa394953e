"""What stands between a runtime and its robot, to look on or to change one thing."""

from hal.guard_reason import GuardReason
from hal.robot import GuardResult, Robot, SensorReadings, WheelSpeeds


class RobotProxy:
    """Passes all on to another robot (hal.robot.Robot), and is one itself. A subclass says what it does otherwise."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot

    def sense(self, now_s: float) -> SensorReadings:
        """As the robot does."""
        return self._robot.sense(now_s)

    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:
        """As the robot does."""
        return self._robot.drive(wanted, decided_at_s, now_s)

    def emergency_stop(self, reason: GuardReason) -> None:
        """As the robot does."""
        self._robot.emergency_stop(reason)

    def release(self) -> None:
        """As the robot does."""
        self._robot.release()

    def close(self) -> None:
        """As the robot does."""
        self._robot.close()
