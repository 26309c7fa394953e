"""A robot that is led through streets in thought: way, turns and what its sides see are told, step by step."""

import math

from hal.kurt2_settings import load_kurt2
from hal.robot import SensorReadings
from kurt2rt.core.decision.decision import JunctionEvent
from kurt2rt.core.mid.junction_detector import JunctionDetector
from kurt2rt.core.mid.settings import load_mid_level

ROBOT = load_kurt2()
STREET_M, OPEN_M = 0.235, 0.60
_STEP_M = 0.005
_LEFT, _RIGHT = ("s1", "s3", "s4", "s2"), ("s5", "s7", "s8", "s6")


def sensed(
    left_m: float, right_m: float, way_m: float = 0.0, turn_rad: float = 0.0, askew_rad: float = 0.0
) -> SensorReadings:
    """Senses of one tick; `askew_rad`: how far the robot looks to the left of where both walls lead."""
    sensors = {sensor.name: sensor for sensor in ROBOT.infrared.sensors}
    counts = dict.fromkeys(sensors, ROBOT.infrared.floor_counts)
    for names, away_m, outward in ((_LEFT, left_m, -1.0), (_RIGHT, right_m, 1.0)):
        for name in names:
            seen_m = away_m + outward * sensors[name].x_m * math.tan(askew_rad)
            counts[name] = round(ROBOT.infrared.counts_at(seen_m))
    arc_m = turn_rad * ROBOT.geometry.effective_track_m / 2
    left_ticks, right_ticks = (round((way_m + side * arc_m) / ROBOT.geometry.metres_per_tick) for side in (-1.0, 1.0))
    return SensorReadings(0.0, tuple(counts.values()), 0.0, left_ticks, right_ticks, 0.0, 0, 0.0)


class Walk:
    """Shows a detector each step, and keeps what it said."""

    def __init__(self, detector: JunctionDetector | None = None) -> None:
        self.detector = detector or JunctionDetector(load_mid_level("turns").junctions, ROBOT)
        self.passed: list[JunctionEvent] = []

    def go(
        self,
        way_m: float,
        left_m: float = STREET_M,
        right_m: float = STREET_M,
        *,
        turn_deg: float = 0.0,
        askew_deg: float = 0.0,
    ) -> "Walk":
        """Drive a distance between these walls, turning `turn_deg` to the left; distance 0 turns on the spot."""
        steps = max(round(abs(way_m) / _STEP_M), 40)
        for _ in range(steps):
            readings = sensed(left_m, right_m, way_m / steps, math.radians(turn_deg) / steps, math.radians(askew_deg))
            event = self.detector.perceive(readings)
            if event is not None:
                self.passed.append(event)
        return self

    def street(self, way_m: float = 0.6) -> "Walk":
        """Straight on between two walls."""
        return self.go(way_m)

    @property
    def told(self) -> list[str]:
        """Return the turn at each junction."""
        return [event.name for event in self.passed]
