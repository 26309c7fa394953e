import pytest

from behaviors.metrics.eights import Eights, EightsSettings
from config.settings import SettingsError
from simbridge.contracts.simulation import SimulatedPost
from tests.behaviors.metrics.paths import put
from tests.behaviors.metrics.worlds import course_in

WEST, EAST = (1.8, 1.8), (3.1, 1.8)
SETTINGS = EightsSettings(kind="eights", wanted_m=0.45)
MIDDLE = (2.45, 1.8)


def eights() -> Eights:
    metric = Eights(SETTINGS, SimulatedPost("west", *WEST, 0.2), SimulatedPost("east", *EAST, 0.2), "")
    put(metric, MIDDLE, 90.0)
    return metric


def test_a_world_without_two_posts_is_refused() -> None:
    with pytest.raises(SettingsError, match=r"one object .*1"):
        course_in("one_object", SETTINGS)
    assert course_in("two_objects", SETTINGS).unit == "eights"
