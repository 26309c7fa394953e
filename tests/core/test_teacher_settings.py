"""Settings of scripted teachers: shipped profiles, distributions, and errors in a file."""

import random
from itertools import pairwise
from pathlib import Path

import pytest
import yaml

from config import CONFIG_DIR
from hal.settings import SettingsError
from kurt2rt.core.task_settings import load_task, taught_by
from kurt2rt.core.teacher_settings import (
    SUPERHUMAN,
    Delay,
    GammaDelay,
    load_teacher,
)

PEOPLE = ("attentive", "ordinary", "slow")
DRAWS = 2000


def delays_of(name: str) -> tuple[Delay, ...]:
    person = load_teacher(name).person
    assert person is not None
    return person.question_delay, person.mistake_delay, person.reward_delay, person.lapses.duration


@pytest.mark.parametrize("name", PEOPLE)
def test_draw_s_values_stay_within_the_bounds(name: str) -> None:
    for delay in delays_of(name):
        chance = random.Random(1)
        drawn = [delay.draw_s(chance) for _ in range(DRAWS)]
        shortest_s = delay.shortest_s if isinstance(delay, GammaDelay) else 0.0
        assert shortest_s <= min(drawn) < max(drawn) <= delay.longest_s


def test_teachers_each_is_slower_than_the_one_before() -> None:
    medians = []
    for name in PEOPLE:
        chance = random.Random(1)
        medians.append([sorted(delay.draw_s(chance) for _ in range(DRAWS))[DRAWS // 2] for delay in delays_of(name)])
    for sooner, later in pairwise(medians):
        assert all(one < other for one, other in zip(sooner, later, strict=True))


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("errors", {"answers": 1.5, "corrections": 0.0}, r"person\.errors\.answers"),
        ("presses_per_minute", -1, r"person\.presses_per_minute"),
        ("question_delay", {"kind": "uniform"}, r"person\.question_delay"),
        ("patience_s", 0.2, r"person.*patience_s"),
    ],
)
def test_load_teacher_invalid_file_names_the_key(tmp_path: Path, key: str, value: object, words: str) -> None:
    content = yaml.safe_load((CONFIG_DIR / "teachers" / "ordinary.yaml").read_text())
    content["person"][key] = value
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump(content))
    with pytest.raises(SettingsError, match=words):
        load_teacher(str(path))


def test_taught_by_robot_drives_lessons_as_its_teacher_wants() -> None:
    ordinary = load_teacher("ordinary")
    speeds = {name: taught_by(load_task(name), ordinary).teaching.lesson_speed for name in ("wall_following", "circle")}
    assert speeds == {"wall_following": ordinary.lesson_speeds["wall_following"], "circle": 1.0}
    assert speeds["wall_following"] < 1.0


def test_taught_by_robot_asks_as_its_teacher_wants() -> None:
    task = load_task("fleeing")
    shares = {each: taught_by(task, load_teacher(each)).learning.ask_radius_fraction for each in (*PEOPLE, SUPERHUMAN)}
    assert shares == {**dict.fromkeys(PEOPLE, task.learning.ask_radius_fraction), SUPERHUMAN: 1.0}
    assert task.learning.ask_radius_fraction < 1.0
