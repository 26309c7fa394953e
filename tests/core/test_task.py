"""Tasks: their sentence, their slow lessons, and the robots that can drive them."""

from pathlib import Path

import pytest

from config.settings import SettingsError
from config.settings_files import find_config
from hal.robot_settings import load_robot
from kurt2rt.core.task_robot import require_robot_of
from kurt2rt.core.task_settings import load_task


def task_file(folder: Path, what: str) -> Path:
    lines = find_config("tasks", "wall_following").read_text().splitlines()
    path = folder / "mine.yaml"
    path.write_text("\n".join(what if line.startswith("description:") else line for line in lines))
    return path


def test_sentence_of_two_lines_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match="description"):
        load_task(str(task_file(tmp_path, 'description: "one\\ntwo"')))


def test_slow_lesson_rescues_after_a_longer_time() -> None:
    task = load_task("wall_following", changes={"teaching.lesson_speed": "0.6"})
    assert task.teaching.slow_rescue_after_s == pytest.approx(task.teaching.rescue_after_s / 0.6)
    assert load_task("wall_following").teaching.slow_rescue_after_s == task.teaching.rescue_after_s


@pytest.mark.parametrize(
    ("task", "robot"), [("fleeing", "kurt2"), ("school/fleeing", "school"), ("turtlebot/circle", "turtlebot")]
)
def test_robot_with_the_sensors_of_a_task_is_taken(task: str, robot: str) -> None:
    require_robot_of(load_task(task), task, load_robot(robot))


@pytest.mark.parametrize(
    ("task", "robot", "told"),
    [
        ("school/fleeing", "kurt2", "is for the robot school (got the robot kurt2, which lacks its sensors); give "),
        ("fleeing", "school", "is for the robot kurt2 (got the robot school, which lacks its sensors); give --robot-s"),
    ],
)
def test_robot_without_the_sensors_of_a_task_is_refused(task: str, robot: str, told: str) -> None:
    with pytest.raises(SettingsError) as refused:
        require_robot_of(load_task(task), task, load_robot(robot))
    assert f"task {task}: {told}" in str(refused.value)


def test_copy_of_a_robots_task_says_how_to_name_its_robot(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_bytes(find_config("tasks", "school/fleeing").read_bytes())
    with pytest.raises(SettingsError, match="give --robot-settings school, or write robot: school in its file"):
        require_robot_of(load_task(str(path)), str(path), load_robot("kurt2"))


def test_situation_that_does_not_exist_keeps_its_own_error() -> None:
    task = load_task("fleeing").model_copy(update={"situation": "nowhere"})
    with pytest.raises(SettingsError, match="no such name in situations"):
        require_robot_of(task, "fleeing", load_robot("kurt2"))
