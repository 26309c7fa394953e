import math

import pytest

from kurt2rt.experiments.lockstep.episode import StuckDetector
from simbridge.contracts.simulation import Pose, Position

PERIOD_S = 0.01


def stuck_after_s(way: StuckDetector, path: list[Position]) -> float | None:
    """Seconds into a drive until no way was made for a whole window."""
    for tick, position in enumerate(path):
        if way.none_since_window(Pose(*position, 0.0)):
            return tick * PERIOD_S
    return None


def ticks(seconds: float) -> range:
    return range(round(seconds / PERIOD_S))


STANDING = [Position(1.0, 2.0) for _ in ticks(20)]
CIRCLING = [Position(1.0 + 0.4 * math.cos(i / 100), 2.0 + 0.4 * math.sin(i / 100)) for i in ticks(20)]
ROUND_A_ROOM = [Position(1.5 + 1.0 * math.cos(i / 400), 2.0 + 1.0 * math.sin(i / 400)) for i in ticks(60)]
TRAVELLING = [Position(0.003 * i, 0.0) for i in ticks(20)]


@pytest.mark.parametrize("path", [STANDING, CIRCLING])
def test_stuck_detector_full_window_in_place_is_stuck(path: list[Position]) -> None:
    assert stuck_after_s(StuckDetector(5.0, PERIOD_S), path) == 5.0


@pytest.mark.parametrize("path", [TRAVELLING, ROUND_A_ROOM])
def test_travelling_is_way_made_also_round_the_same_room(path: list[Position]) -> None:
    assert stuck_after_s(StuckDetector(5.0, PERIOD_S), path) is None


def test_a_robot_that_stops_is_found_a_window_later() -> None:
    path = TRAVELLING[:1000] + [TRAVELLING[999]] * 2000
    found_s = stuck_after_s(StuckDetector(5.0, PERIOD_S), path)
    # Its last metre took 3.3 s, and positions are kept each half second.
    assert found_s is not None
    assert 10.0 + 5.0 - 3.34 <= found_s <= 10.0 + 5.0 - 3.33 + 0.5


def test_the_least_way_is_what_tells_slow_from_stuck() -> None:
    crawling = [Position(0.0005 * i, 0.0) for i in ticks(20)]
    assert stuck_after_s(StuckDetector(5.0, PERIOD_S), crawling) == 5.0
    assert stuck_after_s(StuckDetector(5.0, PERIOD_S, least_m=0.2), crawling) is None
