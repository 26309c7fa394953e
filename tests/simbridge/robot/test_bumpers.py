"""Bumpers pressed by contacts."""

import pytest

from simbridge.robot.body import Contact
from simbridge.robot.bumpers import Bumpers
from tests.simbridge.rig import ROBOT

BUMPERS = Bumpers(ROBOT.bumpers, ROBOT.geometry)
HALF_LENGTH_M, HALF_WIDTH_M = ROBOT.geometry.outline_length_m / 2, ROBOT.geometry.outline_width_m / 2


def ahead(left_m: float) -> Contact:
    """Return a contact on the front face, `left_m` from its middle."""
    return Contact(HALF_LENGTH_M, left_m, 1.0, 0.0)


def behind(left_m: float) -> Contact:
    return Contact(-HALF_LENGTH_M, left_m, -1.0, 0.0)


@pytest.mark.parametrize("rounding_m", [-1e-12, 0.0, 1e-12, 5e-4])
def test_bumpers_contact_at_a_corner_presses_the_outer_one(rounding_m: float) -> None:
    edge_m = HALF_WIDTH_M + rounding_m
    assert BUMPERS.pressed([ahead(edge_m)]) == 0b000001
    assert BUMPERS.pressed([ahead(-edge_m)]) == 0b000100
    assert BUMPERS.pressed([behind(edge_m)]) == 0b001000
    assert BUMPERS.pressed([behind(-edge_m)]) == 0b100000


@pytest.mark.parametrize(("left_m", "bits"), [(0.12, 0b001), (0.06, 0b001), (0.04, 0b010), (0.0, 0b010), (-0.1, 0b100)])
def test_bumpers_contact_on_the_face_presses_one(left_m: float, bits: int) -> None:
    assert BUMPERS.pressed([ahead(left_m)]) == bits


def test_bumpers_contact_off_the_bar_presses_none() -> None:
    assert BUMPERS.pressed([ahead(HALF_WIDTH_M + 0.002), ahead(HALF_WIDTH_M + 0.003)]) == 0
    assert BUMPERS.pressed([Contact(HALF_LENGTH_M, HALF_WIDTH_M, 0.2, 0.98)]) == 0  # a wall along the side
    assert BUMPERS.pressed([]) == 0


def test_bumpers_two_contacts_press_all_between() -> None:
    assert BUMPERS.pressed([ahead(HALF_WIDTH_M), ahead(-HALF_WIDTH_M)]) == 0b000111
    assert BUMPERS.pressed([ahead(0.1), ahead(0.0)]) == 0b000011
