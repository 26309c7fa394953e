"""Control loop that drives along a wall at a set distance."""

from hal.robot import SensorReadings, WheelSpeeds
from hal.robot_settings import InfraredSettings


class KeepDistance:
    """Proportional control of distance and angle to the wall, from the outer sensors of one side."""

    finished = False
    lost = False

    def __init__(
        self,
        infrared: InfraredSettings,
        *,
        front_sensor: str,
        back_sensor: str,
        distance_m: float,
        speed_m_s: float,
        gain_per_m: float,
    ) -> None:
        """Set the loop up. Raises ValueError for sensors that are unknown or not on one side, front before back."""
        self._infrared = infrared
        for name in (front_sensor, back_sensor):
            if name not in infrared.names:
                raise ValueError(f"there is no sensor {name}")
        self._front = infrared.names.index(front_sensor)
        self._back = infrared.names.index(back_sensor)
        front, back = infrared.sensors[self._front], infrared.sensors[self._back]
        self._baseline_m = front.x_m - back.x_m
        if front.heading_deg != back.heading_deg or self._baseline_m <= 0:
            raise ValueError(
                f"{front_sensor} and {back_sensor} must look to the same side, the first before the second"
            )
        self._towards_left = 1.0 if front.heading_deg > 0 else -1.0
        self._distance_m = distance_m
        self._speed_m_s = speed_m_s
        self._gain_per_m = gain_per_m

    @property
    def forward_m_s(self) -> float:
        """Return the speed of the robot's centre in m/s; negative when it backs."""
        return self._speed_m_s

    def start(self) -> None:
        """Do nothing: the loop has no state."""

    def step(self, readings: SensorReadings) -> WheelSpeeds:
        """Return wheel speeds in m/s that steer towards the set distance and parallel to the wall."""
        front_m = self._infrared.distance_m(readings.infrared_counts[self._front])
        back_m = self._infrared.distance_m(readings.infrared_counts[self._back])
        too_far_m = 0.5 * (front_m + back_m) - self._distance_m
        turned_away = (front_m - back_m) / self._baseline_m
        steer = self._towards_left * (self._gain_per_m * too_far_m + turned_away)
        steer = max(-1.0, min(1.0, steer))
        return WheelSpeeds(self._speed_m_s * (1.0 - steer), self._speed_m_s * (1.0 + steer))
