"""Direct motor values, the lowest level of action (paper, V.A)."""

from hal.robot import SensorReadings, WheelSpeeds


class MotorPrimitive:
    """Fixed speeds of both sides for as long as the action is active."""

    finished = False
    lost = False

    def __init__(self, wheel_speeds: WheelSpeeds) -> None:
        self.wheel_speeds = wheel_speeds

    @property
    def forward_m_s(self) -> float:
        """Return the speed of the robot's centre in m/s; negative when it backs."""
        return (self.wheel_speeds.left_m_s + self.wheel_speeds.right_m_s) / 2

    def start(self) -> None:
        """Do nothing: a motor primitive has no state."""

    def step(self, readings: SensorReadings) -> WheelSpeeds:  # noqa: ARG002 - a motor primitive looks at nothing
        """Return the fixed wheel speeds in m/s."""
        return self.wheel_speeds
