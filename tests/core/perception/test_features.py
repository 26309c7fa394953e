"""Recent features from sensor counts."""

from collections.abc import Mapping, Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hal.robot import STANDSTILL, WheelSpeeds
from hal.robot_settings import load_robot
from kurt2rt.core.perception.definition import Reading, SituationDefinition, load_situation
from kurt2rt.core.perception.perception import Perception
from tests.core.perception.helpers import ALL_KINDS, EXTREMES, ORIENTATIONS, READINGS, SENSORS, definition, sensed

Features = Sequence[Mapping[str, object]]


class Fresh(Reading):
    kind: str = "fresh"  # type: ignore[assignment]

    def expression(self, _counts: Sequence[str]) -> str:
        return "7 + round(readings.infrared_age_s)"


def perceived(
    situation: SituationDefinition, *counts: int, driven: WheelSpeeds = STANDSTILL, sensors: tuple[str, ...] = SENSORS
) -> list[float]:
    perception = Perception(situation, sensors)
    perception.remember_driven(driven)
    return list(perception.perceive(sensed(*counts), history_frozen=False).vector[: len(situation.features)])


@pytest.mark.parametrize(
    ("features", "counts", "by_hand"),
    [
        (READINGS, (10, 20, 30, 40), [20, 10]),
        (EXTREMES, (10, 20, 30, 40), [30, 20, 40]),
        (EXTREMES, (50, 20, 30, 5), [50, 5, 5]),
        (ORIENTATIONS, (10, 25, 0, 0), [0, 15]),
        (ORIENTATIONS, (25, 10, 0, 0), [15, 0]),
        (ORIENTATIONS, (25, 25, 0, 0), [0, 0]),
        (READINGS, (0, 1023, 0, 0), [1023, 0]),
    ],
)
def test_features_of_each_kind_in_configured_order(
    features: Features, counts: tuple[int, ...], by_hand: list[int]
) -> None:
    assert perceived(definition(features), *counts) == by_hand


@given(st.permutations(ALL_KINDS), st.tuples(*[st.integers(0, 1023)] * 4))
def test_features_follow_the_order_of_the_definition(
    order: list[Mapping[str, object]], counts: tuple[int, ...]
) -> None:
    driven = WheelSpeeds(0.2, -0.1)
    alone = [perceived(definition([feature]), *counts, driven=driven)[0] for feature in order]
    assert perceived(definition(order), *counts, driven=driven) == alone


def test_features_of_the_basic_situation_between_walls() -> None:
    """Sensor s<n> shows 100 + 10 n; the features of `basic` follow from the paper's section VI.B.1."""
    sensors = load_robot().infrared.names
    basic = load_situation("basic", sensors)
    counts = tuple(100 + 10 * n for n in range(1, 19))
    assert perceived(basic, *counts, driven=WheelSpeeds(0.3, 0.3), sensors=sensors) == [
        *counts,
        *(210, 190),  # front: s9 to s11
        *(140, 110),  # left: s1 to s4
        *(180, 150),  # right: s5 to s8
        *(240, 220),  # rear: s12 to s14
        *(0, 10),  # left: s2 over s1
        *(0, 10),  # right: s6 over s5
        *(0, 10),  # front: s10 over s9
        *(0, 10),  # rear: s13 over s12
        *(0, 0),  # wheel speeds, which `basic` leaves out of every distance
    ]
    assert basic.dimensions == len(basic.names) == 72
    assert len(set(basic.names)) == 72


def test_a_new_kind_follows_any_reading_but_not_in_a_batch() -> None:
    fresh = Fresh(sensor="a")
    assert perceived(definition().model_copy(update={"features": (fresh,)}), 10, 20, 0, 0) == [7]
    assert fresh.batch_kind(0) is None
