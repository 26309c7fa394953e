"""Mid-level situation of symbols."""

import math

import numpy as np
import pytest

from hal.robot import STANDSTILL
from kurt2rt.core.decision.decision import Decision, DecisionCause
from kurt2rt.core.mid.settings import MidSettings, load_mid_level
from kurt2rt.core.mid.situation import MidSituation
from tests.core.mid.walk import OPEN_M, ROBOT, STREET_M, sensed

STANDS = Decision(STANDSTILL, DecisionCause.UNKNOWN, None, None, None)


def driven(action: str | None) -> Decision:
    return STANDS._replace(cause=DecisionCause.RLA, action=action)


class Led:
    """A robot that is led from junction to junction."""

    def __init__(self, settings: MidSettings) -> None:
        self.settings = settings
        self.situation: MidSituation = settings.build(ROBOT)
        self.changes = 0

    def go(self, way_m: float, away_m: float = STREET_M, *, turn_deg: float = 0.0, before: Decision = STANDS) -> "Led":
        steps = 100
        for _ in range(steps):
            readings = sensed(away_m, away_m, way_m / steps, math.radians(turn_deg) / steps)
            self.changes += self.situation.perceive(readings, before)
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


def test_history_reports_a_junction_in_its_tick_only() -> None:
    situation = load_mid_level("turns").build(ROBOT)
    seen = []
    for away_m, steps in ((STREET_M, 100), (OPEN_M, 160), (STREET_M, 100)):
        for _ in range(steps):
            changed = situation.perceive(sensed(away_m, away_m, 0.005), STANDS)
            assert changed == (situation.passed is not None)
            seen.append(situation.passed)
    assert [each.name for each in seen if each is not None] == ["straight"]


def test_history_restart_is_empty() -> None:
    led = Led(load_mid_level("turns")).go(0.5).over(90.0, 0.0)
    led.go(0.8, OPEN_M)
    led.situation.restart()
    assert led.situation.vector.tolist() == [0.0] * 12
    assert led.go(0.5).words == []
    assert led.over(-90.0).words == ["right"]


def test_turn_symbols_are_reported_once() -> None:
    led = Led(load_mid_level("low_passed")).go(1.0)
    assert led.words == ["street"]
    led.over(90.0, 90.0, 0.0)
    assert led.words == ["street", "crossing", "street", "left", "street", "left", "street"]
    led.go(0.4, turn_deg=12.0).go(0.4, turn_deg=-12.0)
    assert len(led.words) == 7


def test_turn_symbols_include_turns_on_the_spot() -> None:
    led = Led(load_mid_level("low_passed")).go(1.0).go(0.3, OPEN_M).go(0.0, OPEN_M, turn_deg=-90.0).go(1.0)
    assert led.words == ["street", "right", "street"]


def test_action_symbols_count_changes() -> None:
    led = Led(load_mid_level("actions"))
    for action in ("forward", "forward", None, "forward", "sharp_left", "stand", "sharp_left", "forward"):
        led.situation.perceive(sensed(STREET_M, STREET_M), driven(action))
    assert led.words == ["forward", "sharp_left", "forward"]
    led.situation.restart()
    led.situation.perceive(sensed(STREET_M, STREET_M), driven("forward"))
    assert led.words == ["forward"]


@pytest.mark.parametrize("name", ["turns", "low_passed", "actions"])
def test_describe_names_each_symbol(name: str) -> None:
    situation = load_mid_level(name).situation
    assert situation.describe(np.array([1.0, 0.0, 2.0] + [0.0] * 9))[1] == ""
    assert all(situation.describe([1.0] * 12))


def test_expectation_symbols_skip_rare_follow_ups() -> None:
    mid = load_mid_level("expectations")
    situation = mid.build(ROBOT, {(1, 2): 5, (1, 3): 2, (2, 3): 1, (3, 1): 4})
    for rla_id in (1, 1, 2, 3, 1, 3, None, 2, 3):
        situation.perceive(sensed(STREET_M, STREET_M), STANDS._replace(rla_id=rla_id))
    # 1 is followed by 2, as ever, that by 3, that by 1; then 3 follows, which it seldom does; standing ends a chain.
    assert [word for word in mid.situation.describe(situation.vector) if word] == ["3", "1", "3", "2"]
