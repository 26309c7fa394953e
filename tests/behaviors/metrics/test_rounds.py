import pytest

from behaviors.metrics.rounds import RoundsSettings
from config.settings import SettingsError
from tests.behaviors.metrics.worlds import course_in

LEFT = RoundsSettings(kind="rounds", wanted_m=0.45, within_m=0.8, turning="left")


def test_a_world_without_a_single_post_is_refused() -> None:
    with pytest.raises(SettingsError, match=r"two objects .*2"):
        course_in("two_objects", LEFT)
    assert course_in("one_object", LEFT).unit == "rounds"
