"""Sectors of a laser scan: the nearest valid range, and invalid ranges as REP 117 says."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kurt2rt.ros.laser_scan import SectorReduction
from kurt2rt.ros.messages import InvalidMessageError, LaserScan
from tests.ros.examples import HEADER

RAYS = 360
HEADINGS = tuple(range(0, 360, 15))
NEAR, FAR = 0.12, 3.5


def scan(ranges: "list[float] | np.ndarray", first_deg: float = 0.0, step_deg: float | None = None) -> LaserScan:
    step_rad = math.radians(360 / len(ranges) if step_deg is None else step_deg)
    first_rad = math.radians(first_deg)
    values = np.asarray(ranges, dtype=np.float32)
    nothing = np.zeros(0, dtype=np.float32)
    return LaserScan(
        HEADER, first_rad, first_rad + step_rad * len(values), step_rad, 0.0, 0.2, NEAR, FAR, values, nothing
    )


def reduce(message: LaserScan, *, zero_is_far: bool = False) -> tuple[float, ...]:
    return SectorReduction(HEADINGS, zero_is_far=zero_is_far).distances_m(message)


@given(st.lists(st.floats(0.125, 3.5, width=32), min_size=RAYS, max_size=RAYS))
def test_sectors_distance_is_the_nearest_of_their_rays(ranges: list[float]) -> None:
    expected = [min(ranges[(heading + offset) % RAYS] for offset in range(-7, 8)) for heading in HEADINGS]
    assert list(reduce(scan(ranges))) == expected


def test_sectors_scan_of_front_alone_leaves_the_rest_unmeasured() -> None:
    found = reduce(scan([1.0] * 180, first_deg=-90, step_deg=1))
    assert [math.isnan(found[index]) for index in (0, 6, 12, 18)] == [False, False, True, False]


@pytest.mark.parametrize(
    "wrong",
    [
        *({"range_max": math.inf}, {"range_min": math.nan}, {"range_min": 4.0}, {"angle_increment": 0.0}),
        *({"angle_increment": math.nan}, {"angle_min": math.inf}, {"ranges": np.zeros(0, dtype=np.float32)}),
    ],
)
def test_sectors_senseless_scan_is_refused(wrong: dict[str, object]) -> None:
    message = scan([1.0] * RAYS)
    for key, value in wrong.items():
        setattr(message, key, value)
    with pytest.raises(InvalidMessageError, match="make no sense"):
        reduce(message)


def test_sectors_thing_that_came_too_near_stays_near() -> None:
    reduction = SectorReduction(HEADINGS, zero_is_far=True)
    gone, wall = [0.0] * RAYS, [0.0] * 80 + [0.15] * 20 + [0.0] * 260
    assert reduction.distances_m(scan(gone))[6] == math.inf
    assert reduction.distances_m(scan(wall))[6] == pytest.approx(0.15)
    for _ in range(3):
        assert reduction.distances_m(scan(gone))[6] == pytest.approx(NEAR)
    assert reduction.distances_m(scan([1.0] * RAYS))[6] == 1.0
    assert reduction.distances_m(scan(gone))[6] == math.inf


def test_sectors_wall_that_is_driven_into_stays_near() -> None:
    reduction = SectorReduction(HEADINGS, zero_is_far=True)
    for distance_m in (0.22, 0.19, 0.16, 0.13, 0.1, 0.07):
        exact = [distance_m / max(1e-9, math.cos(math.radians(angle))) for angle in range(RAYS)]
        found = reduction.distances_m(scan([each if NEAR <= each <= FAR else 0.0 for each in exact]))
        assert found[0] == pytest.approx(max(NEAR, distance_m), rel=0.02)
        assert found[1] < 0.25
        assert found[12] == math.inf
