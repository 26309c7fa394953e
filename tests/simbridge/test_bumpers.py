"""Which bumpers a contact presses, by where on the body it is."""

import pytest

from simbridge.body import Contact
from simbridge.bumpers import Bumpers
from tests.simbridge.rig import ROBOT

BUMPERS = Bumpers(ROBOT.bumpers, ROBOT.geometry)
HALF_LENGTH_M, HALF_WIDTH_M = ROBOT.geometry.outline_length_m / 2, ROBOT.geometry.outline_width_m / 2


def ahead(left_m: float) -> Contact:
    """A wall ahead that touches the front face so far left of its middle."""
    return Contact(HALF_LENGTH_M, left_m, 1.0, 0.0)


def behind(left_m: float) -> Contact:
    return Contact(-HALF_LENGTH_M, left_m, -1.0, 0.0)


@pytest.mark.parametrize("rounding_m", [-1e-12, 0.0, 1e-12, 5e-4])
def test_at_the_bodys_very_corner_the_outer_bumper_is_pressed_however_its_place_is_rounded(rounding_m: float) -> None:
    edge_m = HALF_WIDTH_M + rounding_m
    assert BUMPERS.pressed([ahead(edge_m)]) == 0b000001
    assert BUMPERS.pressed([ahead(-edge_m)]) == 0b000100
    assert BUMPERS.pressed([behind(edge_m)]) == 0b001000
    assert BUMPERS.pressed([behind(-edge_m)]) == 0b100000


@pytest.mark.parametrize(("left_m", "bits"), [(0.12, 0b001), (0.06, 0b001), (0.04, 0b010), (0.0, 0b010), (-0.1, 0b100)])
def test_away_from_the_edges_one_bumper_is_pressed(left_m: float, bits: int) -> None:
    assert BUMPERS.pressed([ahead(left_m)]) == bits


def test_what_is_beside_the_bar_presses_nothing() -> None:
    assert BUMPERS.pressed([ahead(HALF_WIDTH_M + 0.002), ahead(HALF_WIDTH_M + 0.003)]) == 0
    assert BUMPERS.pressed([Contact(HALF_LENGTH_M, HALF_WIDTH_M, 0.2, 0.98)]) == 0  # a wall along the side
    assert BUMPERS.pressed([]) == 0


def test_a_wall_that_meets_the_face_at_two_points_presses_all_between() -> None:
    assert BUMPERS.pressed([ahead(HALF_WIDTH_M), ahead(-HALF_WIDTH_M)]) == 0b000111
    assert BUMPERS.pressed([ahead(0.1), ahead(0.0)]) == 0b000011
