"""Control loop along a wall, on either side."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from behaviors.keep_distance import KeepDistance
from hal.robot import WheelSpeeds
from tests.behaviors.helpers import ROBOT, counts, sensed

SIDES = {"left": ("s1", "s2"), "right": ("s5", "s6")}


def along(side: str, *, front: str | None = None, back: str | None = None) -> KeepDistance:
    front_sensor, back_sensor = SIDES[side]
    return KeepDistance(
        ROBOT.infrared,
        front_sensor=front or front_sensor,
        back_sensor=back or back_sensor,
        distance_m=0.22,
        speed_m_s=0.30,
        gain_per_m=4.0,
    )


def driven(side: str, front_m: float, back_m: float) -> WheelSpeeds:
    front, back = SIDES[side]
    return along(side).step(sensed(counts(**{front: front_m, back: back_m})))


def turn_towards_wall_m_s(side: str, front_m: float, back_m: float) -> float:
    """Return the excess speed of the far side; positive turns the robot to the wall."""
    speeds = driven(side, front_m, back_m)
    left_turn = speeds.right_m_s - speeds.left_m_s
    return left_turn if side == "left" else -left_turn


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize(
    ("front_m", "back_m", "least_m_s", "most_m_s"),
    [
        (0.22, 0.22, -0.01, 0.01),  # at the wanted distance
        (0.30, 0.30, 0.1, 0.6),  # too far
        (0.14, 0.14, -0.6, -0.1),  # too near
        (0.25, 0.19, 0.1, 0.6),  # turned away from it
        (0.19, 0.25, -0.6, -0.1),  # turned to it
        (0.60, 0.60, 0.599, 0.601),  # the wall is lost: looked for on its side
    ],
)
def test_it_steers_to_the_wanted_distance(
    side: str, front_m: float, back_m: float, least_m_s: float, most_m_s: float
) -> None:
    assert least_m_s < turn_towards_wall_m_s(side, front_m, back_m) < most_m_s


def test_left_and_right_are_mirror_images() -> None:
    for front_m, back_m in ((0.12, 0.3), (0.25, 0.2), (0.4, 0.6)):
        left, right = driven("left", front_m, back_m), driven("right", front_m, back_m)
        assert right == pytest.approx(WheelSpeeds(left.right_m_s, left.left_m_s))


@given(st.tuples(*[st.integers(0, 1023)] * 18), st.sampled_from(sorted(SIDES)))
def test_speeds_stay_between_zero_and_twice_the_set_speed(infrared_counts: tuple[int, ...], side: str) -> None:
    speeds = along(side).step(sensed(infrared_counts))
    assert all(math.isfinite(speed) and -1e-12 <= speed <= 0.6 + 1e-12 for speed in speeds)
    assert sum(speeds) == pytest.approx(2 * 0.30)
