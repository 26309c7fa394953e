"""Control loop that drives along a wall at a set distance."""

from typing import NamedTuple

from hal.robot import SensorReadings, WheelSpeeds
from hal.robot_settings import InfraredSettings


class KeepDistanceNumbers(NamedTuple):
    """Constants of the control loop that keeps a distance from a wall."""

    towards_left: float
    """1 for sensors on the left, -1 for sensors on the right."""
    distance_m: float
    speed_m_s: float
    gain_per_m: float
    baseline_m: float
    """Distance between both sensors."""


def steer(front_m: float, back_m: float, want: KeepDistanceNumbers) -> tuple[float, float]:
    """Return the speeds of the left and the right side in m/s that lead back to the set distance from a wall.

    `front_m`, `back_m`: distances in m of the sensors that look at the wall. A batch compiles this function, too.
    """
    too_far_m = 0.5 * (front_m + back_m) - want.distance_m
    turned_away = (front_m - back_m) / want.baseline_m
    turn = want.towards_left * (want.gain_per_m * too_far_m + turned_away)
    turn = max(-1.0, min(1.0, turn))
    return want.speed_m_s * (1.0 - turn), want.speed_m_s * (1.0 + turn)


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
        self.front, self.back = infrared.names.index(front_sensor), infrared.names.index(back_sensor)
        """Places of both sensors in the sensor table."""
        front, back = infrared.sensors[self.front], infrared.sensors[self.back]
        baseline_m = front.x_m - back.x_m
        if front.heading_deg != back.heading_deg or baseline_m <= 0:
            raise ValueError(
                f"{front_sensor} and {back_sensor} must look to the same side, the first before the second"
            )
        towards_left = 1.0 if front.heading_deg > 0 else -1.0
        self.numbers = KeepDistanceNumbers(towards_left, distance_m, speed_m_s, gain_per_m, baseline_m)

    @property
    def forward_m_s(self) -> float:
        """Return the set speed of the robot's centre in m/s; negative when it backs."""
        return self.numbers.speed_m_s

    def start(self) -> None:
        """Do nothing: the loop has no state."""

    def step(self, readings: SensorReadings) -> WheelSpeeds:
        """Return wheel speeds in m/s that steer towards the set distance and parallel to the wall."""
        front_m = self._infrared.distance_m(readings.infrared_counts[self.front])
        back_m = self._infrared.distance_m(readings.infrared_counts[self.back])
        return WheelSpeeds(*steer(front_m, back_m, self.numbers))
