"""Appraisal features from sensor readings."""

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from behaviors.judges.judge import AppraisalFeatures
from config.settings import SettingsError
from hal.robot import SensorReadings
from kurt2rt.core.critic.appraisal_features import AppraisalPerception
from kurt2rt.core.critic.settings import CriticSettings, load_critic
from tests.behaviors.helpers import ROBOT, counts

CRITIC = load_critic()
TICKS_PER_M = 1 / ROBOT.geometry.metres_per_tick


def readings(
    left_m_s: float = 0.0, right_m_s: float = 0.0, *, bumpers: int = 0, age_s: float = 0.0, **distances_m: float
) -> SensorReadings:
    """Return the readings of a tick at these wheel speeds, with objects at these distances from the sensors."""
    left, right = (round(speed * 0.01 * TICKS_PER_M) for speed in (left_m_s, right_m_s))
    return SensorReadings(0.0, counts(0.7, **distances_m), age_s, left, right, 0.0, bumpers, 0.0)


def perception() -> AppraisalPerception:
    return AppraisalPerception(CRITIC, ROBOT)


def after(
    seconds: float, of: AppraisalPerception, sensed: SensorReadings, *, driving: bool = True
) -> AppraisalFeatures:
    """AppraisalFeatures of the last tick of so many alike."""
    for _ in range(round(seconds * 100)):
        circumstances = of.perceive(sensed, driving=driving)
    return circumstances


def changed(**perception_values: object) -> CriticSettings:
    content = CRITIC.model_dump(mode="json")
    content["perception"].update(perception_values)
    return CriticSettings.model_validate_json(json.dumps(content))


# Distances and angles


# How it moves


# No progress


# No wall


# Starting again


@given(
    ticks=st.lists(
        st.tuples(
            st.lists(st.integers(0, 1023), min_size=18, max_size=18), *[st.integers(-500, 500)] * 2, st.booleans()
        ),
        max_size=30,
    )
)
def test_features_are_deterministic_and_finite(ticks: list[tuple[list[int], int, int, bool]]) -> None:
    one, other = perception(), perception()
    for seen, left, right, driving in ticks:
        sensed = SensorReadings(0.0, tuple(seen), 0.0, left, right, 0.0, 0, 0.0)
        here = one.perceive(sensed, driving=driving)
        assert here == other.perceive(sensed, driving=driving)
        assert all(map(math.isfinite, here))


# Settings that do not fit


def test_perception_unknown_sensors_are_refused() -> None:
    sensors = CRITIC.model_dump(mode="json")["perception"]["sensors"] | {"ahead_left": ["s15", "s99"]}
    with pytest.raises(SettingsError, match=r"critic basic: perception\.sensors: .* s99;"):
        AppraisalPerception(changed(sensors=sensors), ROBOT)


def test_perception_reversed_side_is_refused() -> None:
    sensors = CRITIC.model_dump(mode="json")["perception"]["sensors"] | {"right": ["s6", "s5"]}
    with pytest.raises(SettingsError, match=r"perception\.sensors: s6 .*s5;"):
        AppraisalPerception(changed(sensors=sensors), ROBOT)


# Circling


def circling() -> AppraisalPerception:
    return AppraisalPerception(changed(circling={"round_rad": 3.0, "reversal_rad": 0.6}), ROBOT)


def test_circling_ends_with_a_turn_to_the_other_side() -> None:
    of = circling()
    assert after(10.0, of, readings(0.1, 0.3)).circling == 1.0
    assert after(1.0, of, readings(0.3, 0.3)).circling == 1.0
    assert after(1.5, of, readings(0.3, 0.1)).circling == 0.0


# Grazing


# Spun
