"""Mid-level situation of symbols."""

import math

from kurt2rt.core.mid.settings import MidSettings, MidSituation, load_mid_level
from tests.core.mid.walk import OPEN_M, ROBOT, STREET_M, sensed


def test_builtin_mid_level_matches_the_paper() -> None:
    mid = load_mid_level("turns")
    assert (mid.space.dimensions, mid.space.radius, mid.space.metric) == (12, 6.0, "hamming")
    assert mid.situation.kind == "history"
    assert mid.features[0] == "symbol 1"
    assert load_mid_level(mid) is mid


class Led:
    """A robot that is led from junction to junction."""

    def __init__(self, settings: MidSettings) -> None:
        self.settings = settings
        self.situation: MidSituation = settings.build(ROBOT)
        self.changes = 0

    def go(self, way_m: float, away_m: float = STREET_M, *, turn_deg: float = 0.0) -> "Led":
        steps = 100
        for _ in range(steps):
            readings = sensed(away_m, away_m, way_m / steps, math.radians(turn_deg) / steps)
            self.changes += self.situation.perceive(readings)
        return self

    def over(self, *turns_deg: float) -> "Led":
        """Drive over a number of junctions, with a street after each."""
        for turn_deg in turns_deg:
            self.go(0.8, OPEN_M, turn_deg=turn_deg).go(1.0)
        return self

    @property
    def words(self) -> list[str]:
        """Return the names of the symbols, newest first."""
        names = self.settings.situation.describe(self.situation.vector)
        return [each for each in names if each]


def test_history_holds_turns_newest_first() -> None:
    led = Led(load_mid_level("turns")).go(0.5)
    assert led.situation.dimensions == len(led.situation.features) == 12
    assert led.situation.vector.tolist() == [0.0] * 12
    led.over(90.0, 0.0, 0.0, -90.0)
    assert led.words == ["right", "straight", "straight", "left"]
    assert led.changes == 4
    led.over(*[0.0] * 11)
    assert led.words == ["straight"] * 11 + ["right"]


def test_history_vector_is_never_changed() -> None:
    led = Led(load_mid_level("turns")).go(0.5)
    before = led.situation.vector
    led.over(90.0)
    assert before.tolist() == [0.0] * 12
    after = led.situation.vector
    led.go(0.3)
    assert led.situation.vector is after
