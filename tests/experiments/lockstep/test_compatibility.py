import pytest

from config.settings import SettingsError
from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.lockstep.compatibility import require_metric
from tests.experiments.helpers import STAGE


@pytest.mark.parametrize(
    ("task", "worlds", "why"),
    [
        ("circle", ("one_object", "a"), r"circle: .*rounds: .*\bA .*\b0\b"),
        ("eight", ("two_objects", "one_object"), r"eight: .*eights: .*\b1\b"),
        ("streets", ("streets-3", "rooms-3"), r"streets: .*junctions: .*rooms-3"),
    ],
)
def test_a_course_that_a_world_cannot_give_is_refused(task: str, worlds: tuple[str, str], why: str) -> None:
    fits, does_not = worlds
    require_metric(STAGE, load_task(task), [fits])
    with pytest.raises(SettingsError, match=why):
        require_metric(STAGE, load_task(task), [fits, does_not])
