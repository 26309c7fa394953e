"""Direct motor values, the lowest level of action (paper, V.A)."""

from hal.robot import SensorReadings, WheelSpeeds


class MotorPrimitive:
    """Fixed speeds of both sides for as long as the action is active."""

    finished = False
    lost = False

    def __init__(self, wheel_speeds: WheelSpeeds) -> None:
        self._wheel_speeds = wheel_speeds

    def start(self) -> None:
        """Do nothing: a motor primitive has no state."""

    def step(self, readings: SensorReadings) -> WheelSpeeds:  # noqa: ARG002 - a motor primitive looks at nothing
        """Return the fixed wheel speeds in m/s."""
        return self._wheel_speeds
