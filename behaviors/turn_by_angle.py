"""Turn on the spot by an angle, measured by the encoders."""

import math

from hal.robot import STANDSTILL, SensorReadings, WheelSpeeds
from hal.robot_settings import GeometrySettings


class TurnByAngle:
    """Action that turns on the spot by an angle, to the left if positive, and then stands."""

    lost = False

    def __init__(self, geometry: GeometrySettings, *, angle_deg: float, speed_m_s: float) -> None:
        # Each side travels the arc of half the effective track.
        self.wanted_m = math.radians(abs(angle_deg)) * geometry.effective_track_m / 2
        self._metres_per_tick = geometry.metres_per_tick
        self._sign = sign = 1.0 if angle_deg > 0 else -1.0
        self.turning = WheelSpeeds(-sign * speed_m_s, sign * speed_m_s)
        self._turned_m = 0.0

    @property
    def finished(self) -> bool:
        """Return whether the wheels have rolled the whole arc."""
        return self._turned_m >= self.wanted_m

    def start(self) -> None:
        """Restart the turn at 0 degrees."""
        self._turned_m = 0.0

    def step(self, readings: SensorReadings) -> WheelSpeeds:
        """Return the turning speeds in m/s until the wheels have rolled the arc, then standstill."""
        # Signed: a robot that still swings the other way has more to turn.
        difference = self._sign * (readings.encoder_right_ticks - readings.encoder_left_ticks)
        self._turned_m += 0.5 * difference * self._metres_per_tick
        return STANDSTILL if self.finished else self.turning
