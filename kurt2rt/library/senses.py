"""Infra-red sensors by name, in metres."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from config.settings import SettingsError
from hal.robot import SensorReadings
from hal.robot_settings import RobotSettings
from kurt2rt.core.perception.sensor_words import infrared_law

SIDES = ("front", "left", "right", "rear")


@dataclass(frozen=True, slots=True)
class Sense:
    """Newest reading of one sensor, or of the sensor of a side with the nearest reading."""

    name: str
    metres: float
    """Distance from the sensor's face, within its range; the end of the range if nothing is in view."""
    detects: bool
    """False: nothing is in view."""
    counts: int
    """Raw reading."""

    def __repr__(self) -> str:
        """Return name and distance."""
        return f"{self.name}: {self.metres:.2f} m" if self.detects else f"{self.name}: nothing within {self.metres} m"


class Senses(Mapping[str, Sense]):
    """Readings by side (front, left, right, rear), by place (`front left edge`) and by sensor name (s1 to s18).

    A side has the nearest reading of all sensors whose place begins with its word.
    """

    def __init__(self, settings: RobotSettings, readings: SensorReadings) -> None:
        law, found = infrared_law(settings.infrared), dict[str, Sense]()
        by_place: dict[str, Sense] = {}
        for sensor, counts in zip(settings.infrared.sensors, readings.infrared_counts, strict=True):
            metres, detects = law.distance_m(counts), law.detects(counts)
            by_place[sensor.label] = Sense(sensor.label, metres, detects, counts)
            found[sensor.name] = Sense(sensor.name, metres, detects, counts)
        for side in SIDES:
            there = [sense for place, sense in by_place.items() if place.split()[0] == side]
            if there:
                nearest = min(there, key=lambda sense: sense.metres)
                found[side] = Sense(side, nearest.metres, nearest.detects, nearest.counts)
        self._found = {**{side: found[side] for side in SIDES if side in found}, **by_place, **found}

    def __getitem__(self, name: str) -> Sense:
        """Return the reading of a side, a place or a sensor. Raises SettingsError for another name."""
        if name not in self._found:
            raise SettingsError(f"unknown (got {name!r}, allowed {', '.join(self._found)})", where="senses")
        return self._found[name]

    def __iter__(self) -> Iterator[str]:
        """Yield all names."""
        return iter(self._found)

    def __len__(self) -> int:
        """Return the number of names."""
        return len(self._found)

    def __repr__(self) -> str:
        """Return the sides."""
        return "; ".join(repr(self._found[side]) for side in SIDES if side in self._found)
