"""Settings of scripted teachers: shipped profiles, distributions, and errors in a file."""

import random
from itertools import pairwise

from kurt2rt.core.task_settings import load_task, taught_by
from kurt2rt.core.teacher_settings import SUPERHUMAN, Delay, load_teacher

PEOPLE = ("attentive", "ordinary", "slow")
DRAWS = 2000


def delays_of(name: str) -> tuple[Delay, ...]:
    person = load_teacher(name).person
    assert person is not None
    return person.question_delay, person.mistake_delay, person.reward_delay, person.lapses.duration


def test_teachers_each_is_slower_than_the_one_before() -> None:
    medians = []
    for name in PEOPLE:
        chance = random.Random(1)
        medians.append([sorted(delay.draw_s(chance) for _ in range(DRAWS))[DRAWS // 2] for delay in delays_of(name)])
    for sooner, later in pairwise(medians):
        assert all(one < other for one, other in zip(sooner, later, strict=True))


def test_taught_by_robot_asks_as_its_teacher_wants() -> None:
    task = load_task("fleeing")
    shares = {each: taught_by(task, load_teacher(each)).learning.ask_radius_fraction for each in (*PEOPLE, SUPERHUMAN)}
    assert shares == {**dict.fromkeys(PEOPLE, task.learning.ask_radius_fraction), SUPERHUMAN: 1.0}
    assert task.learning.ask_radius_fraction < 1.0
