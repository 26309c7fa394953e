"""Every shipped task: its teacher can drive it, its metric measures it, and it can be taught."""

from pathlib import Path

import pytest

from behaviors.repertoire import load_repertoire
from config import CONFIG_DIR
from config.settings import SettingsError
from kurt2rt.core.task_settings import load_task
from tests.experiments.helpers import ROBOT, STAGE, teach

TASKS = sorted(path.stem for path in (CONFIG_DIR / "tasks").glob("*.yaml"))


@pytest.mark.parametrize("name", TASKS)
def test_files_fit_together(name: str) -> None:
    task = load_task(name)
    assert task.name == name
    assert load_repertoire(task.repertoire, ROBOT)
    STAGE.require_worlds(task.teaching.world, *task.exam.worlds)


@pytest.mark.parametrize("name", TASKS)
def test_every_task_has_a_plain_reading_of_the_paper(name: str) -> None:
    task, plain = load_task(name), load_task(name, paper_defaults=True)
    learning = plain.learning
    assert (learning.history_weight, learning.weights) == (1.0, ())
    assert (learning.insert_radius_fraction, learning.minimum_action_s) == (1.0, 0.0)
    assert plain == task.model_copy(update={"learning": task.paper_defaults})


@pytest.mark.parametrize(
    "change",
    [
        {"paper_defaults.history_weight": "0.5"},
        {"paper_defaults.weights": "[{weight: 2.0, features: [s1]}]"},
        {"paper_defaults.insert_radius_fraction": "0.1"},
        {"paper_defaults.minimum_action_s": "0.1"},
    ],
    ids=str,
)
def test_other_reading_is_not_called_plain(change: dict[str, str]) -> None:
    (key,) = change
    with pytest.raises(SettingsError, match=rf"circle\.yaml: {key}: "):
        load_task("circle", changes=change)


@pytest.mark.parametrize("name", ["../circle", "''"])
def test_a_name_that_is_no_name_of_a_file_is_refused(name: str) -> None:
    with pytest.raises(SettingsError, match=r"circle\.yaml: name: "):
        load_task("circle", changes={"name": name})


def test_the_robot_is_set_down_anew_where_the_task_says_so(tmp_path: Path) -> None:
    times = {"supervised_s": 4.0, "corrections_s": 4.5, "reposition_every_s": 1.0}
    task = load_task("circle_repositioned", changes={f"teaching.{key}": str(each) for key, each in times.items()})
    result = teach(tmp_path / "knowledge", task).result
    assert result.counts.repositions == 8
    places = {(round(each.x_m, 1), round(each.y_m, 1)) for each in result.trail}
    assert len(places) > 8
