"""Recent features from sensor counts."""

from collections.abc import Mapping, Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hal.robot import STANDSTILL, WheelSpeeds
from hal.robot_settings import load_robot
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.perception.perception import FeatureExtractor
from tests.core.perception.helpers import ALL_KINDS, EXTREMES, ORIENTATIONS, READINGS, SENSORS, definition

Features = Sequence[Mapping[str, object]]


def extracted(features: Features, counts: tuple[int, ...], driven: WheelSpeeds = STANDSTILL) -> list[int]:
    return list(FeatureExtractor(definition(features), SENSORS)(counts, driven))


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
    assert extracted(features, counts) == by_hand


@given(st.permutations(ALL_KINDS), st.tuples(*[st.integers(0, 1023)] * 4))
def test_features_follow_the_order_of_the_definition(
    order: list[Mapping[str, object]], counts: tuple[int, ...]
) -> None:
    driven = WheelSpeeds(0.2, -0.1)
    alone = [extracted([feature], counts, driven)[0] for feature in order]
    assert extracted(order, counts, driven) == alone


def test_features_of_the_basic_situation_between_walls() -> None:
    """Sensor s<n> shows 100 + 10 n; the features of `basic` follow from the paper's section VI.B.1."""
    sensors = load_robot().infrared.names
    basic = load_situation("basic", sensors)
    counts = tuple(100 + 10 * n for n in range(1, 19))
    values = FeatureExtractor(basic, sensors)(counts, WheelSpeeds(0.3, 0.3))
    assert list(values) == [
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
