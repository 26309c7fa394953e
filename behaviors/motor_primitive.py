"""Direct motor values, the paper's lowest level of action (section V.A)."""

from hal.robot import SensorReadings, WheelSpeeds


class MotorPrimitive:
    """Drives both sides at fixed speeds as long as it is active."""

    finished = False
    """Motor values never are."""
    lost = False

    def __init__(self, wheel_speeds: WheelSpeeds) -> None:
        self._wheel_speeds = wheel_speeds

    def start(self) -> None:
        """Nothing to forget: a motor primitive has no state."""

    def step(self, senses: SensorReadings) -> WheelSpeeds:  # noqa: ARG002 - a motor primitive looks at nothing
        """The same wheel speeds in every tick."""
        return self._wheel_speeds
