import pytest

from behaviors.metrics.eights import EightsSettings
from config.settings import SettingsError
from tests.behaviors.metrics.worlds import course_in

WEST, EAST = (1.8, 1.8), (3.1, 1.8)
SETTINGS = EightsSettings(kind="eights", wanted_m=0.45)
MIDDLE = (2.45, 1.8)


def test_a_world_without_two_posts_is_refused() -> None:
    with pytest.raises(SettingsError, match=r"one object .*1"):
        course_in("one_object", SETTINGS)
    assert course_in("two_objects", SETTINGS).unit == "eights"
