"""Proxy between a runtime and its robot, to observe it or to change one method."""

from hal.guard_reason import GuardReason
from hal.robot import GuardResult, Robot, SensorReadings, WheelSpeeds


class RobotProxy:
    """Robot that forwards all calls to another robot (hal.robot.Robot); a subclass overrides some."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot

    def sense(self, now_s: float) -> SensorReadings:
        """Return the readings of the robot at `now_s`, in s."""
        return self._robot.sense(now_s)

    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:
        """Forward a request to the robot and return its guard's result; speeds in m/s, times in s."""
        return self._robot.drive(wanted, decided_at_s, now_s)

    def emergency_stop(self, reason: GuardReason) -> None:
        """Brake the robot now; it stays stopped until `release`."""
        self._robot.emergency_stop(reason)

    def release(self) -> None:
        """End a latched stop of the robot, unless its cause lasts."""
        self._robot.release()

    def close(self) -> None:
        """Stop the wheels of the robot and close its bus."""
        self._robot.close()
