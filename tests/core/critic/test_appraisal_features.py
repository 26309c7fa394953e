"""Appraisal features from sensor readings."""

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from behaviors.judges.judge import AppraisalFeatures
from hal.robot import SensorReadings
from hal.settings import SettingsError
from kurt2rt.core.critic.appraisal_features import AppraisalPerception
from kurt2rt.core.critic.settings import CriticSettings, load_critic
from tests.behaviors.helpers import ROBOT, counts

CRITIC = load_critic()
TICKS_PER_M = 1 / ROBOT.geometry.metres_per_tick
FAR_M = ROBOT.infrared.far_m


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


def test_distance_is_that_of_the_nearest_object() -> None:
    seen = readings(s4=0.2, s1=0.4, s10=0.3, s8=0.15, s13=0.5, s15=0.25, s16=0.35)
    here = perception().perceive(seen, driving=False)
    near = (here.left_m, here.front_m, here.right_m, here.rear_m, here.ahead_left_m, here.ahead_right_m)
    assert near == pytest.approx((0.2, 0.3, 0.15, 0.5, 0.25, 0.35), abs=0.003)


def test_angle_is_the_turn_away_from_the_wall() -> None:
    away = perception().perceive(readings(s1=0.34, s3=0.3, s4=0.25, s2=0.2, s5=0.15, s6=0.29), driving=False)
    assert away.left_angle_rad == pytest.approx(math.atan(0.14 / 0.28), abs=0.02)
    assert away.right_angle_rad == pytest.approx(-away.left_angle_rad, abs=0.03)


# How it moves


def test_speed_and_turn_rate_follow_the_wheels() -> None:
    moving = perception()
    assert 0 < moving.perceive(readings(0.1, 0.3), driving=True).speed_m_s < 0.05
    here = after(1.0, moving, readings(0.1, 0.3))
    assert here.speed_m_s == pytest.approx(0.2, abs=0.001)
    assert here.turn_rad_s == pytest.approx(0.2 / ROBOT.geometry.effective_track_m, abs=0.005)
    here = after(1.0, moving, readings(-0.2, -0.2))
    assert here.speed_m_s == pytest.approx(-0.2, abs=0.001)
    assert here.turn_rad_s == pytest.approx(0.0, abs=0.001)


def test_bumped_lasts_one_second() -> None:
    bumped = perception()
    assert bumped.perceive(readings(bumpers=0b100), driving=True).bumped == 1.0
    assert after(0.99, bumped, readings()).bumped == 1.0
    assert after(0.01, bumped, readings()).bumped == 0.0


# No progress


def test_no_progress_spinning_after_three_seconds() -> None:
    spinning = perception()
    assert after(3.0, spinning, readings(0.2, -0.2)).no_progress == 0.0
    assert after(0.01, spinning, readings(0.2, -0.2)).no_progress == 1.0


def test_no_progress_to_and_fro_but_not_creeping() -> None:
    shuttling, creeping = perception(), perception()
    for _ in range(5):
        after(0.5, shuttling, readings(0.3, 0.3))
        here = after(0.5, shuttling, readings(-0.3, -0.3))
    assert here.no_progress == 1.0
    assert after(20.0, creeping, readings(0.06, 0.06)).no_progress == 0.0
    assert after(4.0, creeping, readings(0.04, 0.04)).no_progress == 1.0


def test_no_progress_waiting_resets_it() -> None:
    waiting = perception()
    assert after(20.0, waiting, readings(), driving=False).no_progress == 0.0
    assert after(3.0, waiting, readings()).no_progress == 0.0
    assert after(0.01, waiting, readings()).no_progress == 1.0
    assert after(0.01, waiting, readings(), driving=False).no_progress == 0.0
    assert after(3.0, waiting, readings()).no_progress == 0.0


# No wall


def test_no_wall_after_two_seconds() -> None:
    lost = perception()
    assert after(1.99, lost, readings(0.3, 0.3)).no_wall == 0.0
    assert after(0.01, lost, readings(0.3, 0.3)).no_wall == 1.0
    assert lost.perceive(readings(s17=0.5), driving=True).no_wall == 0.0
    assert after(5.0, lost, readings(s5=0.3, s11=0.3)).no_wall == 1.0  # what is elsewhere is not the wall that is meant


def test_no_wall_time_pauses_while_waiting() -> None:
    lost = perception()
    after(1.5, lost, readings())
    assert after(60.0, lost, readings(), driving=False).no_wall == 0.0
    assert after(0.49, lost, readings()).no_wall == 0.0
    assert after(0.01, lost, readings()).no_wall == 1.0


# Starting again


def test_features_reset_after_missing_sensor_data() -> None:
    blinded = perception()
    after(10.0, blinded, readings(0.2, -0.2, bumpers=1))
    here = blinded.perceive(readings(age_s=0.06), driving=False)
    assert here == AppraisalFeatures(*[FAR_M] * 6, *[0.0] * 7)
    here = after(1.99, blinded, readings())
    assert (here.bumped, here.no_progress, here.no_wall) == (0.0, 0.0, 0.0)


def test_features_without_any_sensor_data_are_finite() -> None:
    unborn = SensorReadings(0.0, (0,) * 18, math.inf, 0, 0, math.inf, 0, math.inf)
    assert after(5.0, perception(), unborn) == AppraisalFeatures(*[FAR_M] * 6, *[0.0] * 7)


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


def test_circling_is_noticed_after_a_round_to_either_side() -> None:
    for left_m_s, right_m_s in ((0.1, 0.3), (0.3, 0.1)):
        of = circling()
        turn_rad_s = abs(after(1.0, of, readings(left_m_s, right_m_s)).turn_rad_s)
        assert after(2.9 / turn_rad_s - 1.0, of, readings(left_m_s, right_m_s)).circling == 0.0
        assert after(0.3 / turn_rad_s, of, readings(left_m_s, right_m_s)).circling == 1.0


def test_circling_ends_with_a_turn_to_the_other_side() -> None:
    of = circling()
    assert after(10.0, of, readings(0.1, 0.3)).circling == 1.0
    assert after(1.0, of, readings(0.3, 0.3)).circling == 1.0
    assert after(1.5, of, readings(0.3, 0.1)).circling == 0.0


def test_circling_lasts_while_the_robot_stands() -> None:
    of = circling()
    after(10.0, of, readings(0.1, 0.3))
    assert after(30.0, of, readings(), driving=False).circling == 1.0


def test_circling_ends_with_a_repositioning_or_a_gap() -> None:
    of = circling()
    after(10.0, of, readings(0.1, 0.3))
    of.forget_turns()
    assert of.perceive(readings(0.1, 0.3), driving=True).circling == 0.0
    after(10.0, of, readings(0.1, 0.3))
    assert of.perceive(readings(0.1, 0.3, age_s=9.0), driving=True).circling == 0.0


# Grazing


@pytest.mark.parametrize("sensor", ["s1", "s4", "s8"])
def test_grazing_lasts_as_configured(sensor: str) -> None:
    of = AppraisalPerception(changed(grazing={"near_m": 0.12, "held_s": 0.1}), ROBOT)
    near, clear = (readings()._replace(infrared_counts=counts(0.7, **{sensor: each_m})) for each_m in (0.11, 0.14))
    assert of.perceive(clear, driving=True).grazing == 0.0
    assert of.perceive(near, driving=True).grazing == 1.0
    assert after(0.1, of, clear).grazing == 1.0
    assert of.perceive(clear, driving=True).grazing == 0.0


def test_grazing_is_about_the_sides() -> None:
    of = AppraisalPerception(changed(grazing={"near_m": 0.12, "held_s": 0.1}), ROBOT)
    assert of.perceive(readings(s10=0.11, s13=0.11, s15=0.11), driving=True).grazing == 0.0


# Spun


def spinning() -> AppraisalPerception:
    return AppraisalPerception(changed(spun={"turn_rad_s": 0.9, "speed_m_s": 0.1, "held_s": 0.5}), ROBOT)


def test_spun_lasts_as_configured_after_a_turn_on_the_spot() -> None:
    of = spinning()
    assert after(1.0, of, readings(-0.3, 0.3)).spun == 1.0
    assert after(0.5, of, readings(0.3, 0.3)).spun == 1.0
    assert after(0.3, of, readings(0.3, 0.3)).spun == 0.0


def test_circling_fades_over_the_way_as_configured() -> None:
    settings = {"round_rad": 6.0, "reversal_rad": 0.6, "fades_in_m": 0.3}
    of = AppraisalPerception(changed(circling=settings), ROBOT)
    assert after(6.0, of, readings(-0.3, 0.3)).circling == 1.0
    assert after(2.0, of, readings(0.3, 0.3)).circling == 0.0
    assert after(60.0, of, readings(0.1, 0.3)).circling == 0.0
