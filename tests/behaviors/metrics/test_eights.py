import pytest

from behaviors.metrics.eights import Eights, EightsSettings
from config.settings import SettingsError
from simbridge.contracts.simulation import SimulatedPost
from tests.behaviors.metrics.paths import Point, arc, follow, put
from tests.behaviors.metrics.worlds import course_in

WEST, EAST = (1.8, 1.8), (3.1, 1.8)
SETTINGS = EightsSettings(kind="eights", wanted_m=0.45)
HALF_GAP_M = 0.65
WEST_LEFT = arc(WEST, HALF_GAP_M, 0.0, 360.0)
"""Round the western post counter-clockwise, from the middle and back to it."""
EAST_RIGHT = arc(EAST, HALF_GAP_M, 180.0, -180.0)
MIDDLE = (2.45, 1.8)


def eights() -> Eights:
    metric = Eights(SETTINGS, SimulatedPost("west", *WEST, 0.2), SimulatedPost("east", *EAST, 0.2), "")
    put(metric, MIDDLE, 90.0)
    return metric


def driven(*rounds: list[Point]) -> float:
    metric = eights()
    # A little way on, since a round is over where the other post's side of the floor begins.
    follow(metric, [point for each in rounds for point in each] + [(2.4, 1.9), (2.5, 1.9), (2.4, 1.9)])
    return metric.progress


@pytest.mark.parametrize(
    ("rounds", "progress"),
    [
        ([WEST_LEFT], 0.5),
        ([WEST_LEFT, EAST_RIGHT], 1.0),
        ([WEST_LEFT, EAST_RIGHT, WEST_LEFT], 1.5),
        ([WEST_LEFT, EAST_RIGHT] * 3, 3.0),
        ([WEST_LEFT] * 5, 0.5),  # not in turn
        ([WEST_LEFT[::-1], EAST_RIGHT[::-1]], 0.0),  # the wrong way round
        ([WEST_LEFT, EAST_RIGHT[::-1], WEST_LEFT], 0.5),  # the eastern post is still to come
        ([WEST_LEFT[:120], WEST_LEFT[:120][::-1]], 0.0),  # turned back on the way
    ],
)
def test_eights_round_about_other_post_counts_half(rounds: list[list[Point]], progress: float) -> None:
    assert driven(*rounds) == progress


def test_a_round_that_a_hand_broke_off_does_not_count() -> None:
    metric = eights()
    follow(metric, WEST_LEFT[:120])
    put(metric, (2.0, 1.2), 0.0)
    follow(metric, [*arc(WEST, HALF_GAP_M, -60.0, 0.0), *EAST_RIGHT, MIDDLE, (2.4, 1.8)])
    assert metric.progress == 0.5  # the eastern one alone


def test_a_world_without_two_posts_is_refused() -> None:
    with pytest.raises(SettingsError, match=r"one object .*1"):
        course_in("one_object", SETTINGS)
    assert course_in("two_objects", SETTINGS).unit == "eights"
