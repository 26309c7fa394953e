"""Robots are taught in a batch as on the CAN bus, bit by bit."""

from collections.abc import Mapping
from itertools import cycle

import pytest

from kurt2rt.core.task_settings import TaskSettings, load_task, taught_by
from kurt2rt.core.teacher_settings import load_teacher
from kurt2rt.experiments.lockstep.lesson import GivenLesson
from simbridge.batch.compiled import IS_COMPILED
from tests.simbridge.batch.equal_lessons import TASKS, batch_lesson, lesson_in_both

SECONDS = 18.0 if IS_COMPILED else 3.0
BLIND_TEACHER = dict.fromkeys(("policy.front_m", "policy.edge_m", "policy.wary_m"), "0.05")
"""Thresholds of a teacher who does not turn away in time."""


def lesson_task(
    name: str, teacher: str, changes: Mapping[str, str] | None = None, *, paper_defaults: bool = False
) -> TaskSettings:
    """Return a short lesson; a third of it without corrections."""
    times = {"teaching.supervised_s": f"{SECONDS / 3:.2f}", "teaching.corrections_s": f"{SECONDS * 2 / 3:.2f}"}
    task = load_task(name, paper_defaults=paper_defaults, changes={**times, **(changes or {})})
    return taught_by(task, load_teacher(teacher))


def equal_lesson(task: TaskSettings, seed: int) -> GivenLesson:
    """Check that a lesson is equal both ways, and return it."""
    lesson = lesson_in_both(task, seed)
    assert lesson is not None, "the robot left the batch"
    return lesson


@pytest.mark.parametrize(("name", "teacher"), list(zip(TASKS, cycle(["superhuman", "ordinary"]), strict=False)))
def test_lesson_is_equal_in_the_batch(name: str, teacher: str) -> None:
    assert equal_lesson(lesson_task(name, teacher), 7).events


@pytest.mark.parametrize(("name", "teacher"), [("streets", "ordinary")])
def test_lesson_of_the_plain_reading_is_equal_in_the_batch(name: str, teacher: str) -> None:
    assert equal_lesson(lesson_task(name, teacher, paper_defaults=True), 7).events


@pytest.mark.deep
@pytest.mark.skipif(not IS_COMPILED, reason="plain Python takes minutes")
@pytest.mark.parametrize("teacher", ["superhuman", "answers_only", "attentive", "ordinary", "slow"])
@pytest.mark.parametrize("name", TASKS)
def test_lesson_of_two_minutes_is_equal_in_the_batch(name: str, teacher: str) -> None:
    task = lesson_task(name, teacher, {"teaching.supervised_s": "30", "teaching.corrections_s": "90"})
    lesson = lesson_in_both(task, 11)
    # A sensor looks broken of the eight by `answers_only`, so the robot belongs on the CAN bus.
    assert lesson is None or lesson.events


def test_lesson_by_rewind_is_equal_in_the_batch() -> None:
    longer = {"teaching.corrections_s": "28"} if IS_COMPILED else {}
    lesson = equal_lesson(lesson_task("wall_following", "slow", longer), 2)
    assert not IS_COMPILED or any(minute.stops for minute in lesson.result.counts.workload)


def test_lesson_with_collisions_is_equal_in_the_batch() -> None:
    task = lesson_task("fleeing", "superhuman", BLIND_TEACHER | {"teaching.reposition_every_s": "4"})
    result = equal_lesson(task, 1).result
    assert not IS_COMPILED or result.counts.collisions
    assert not IS_COMPILED or result.counts.repositions


def test_lesson_until_right_ends_in_the_batch_as_on_the_bus() -> None:
    clean = {"teaching.until_right": "true", "teaching.clean_drive_s": "2.5"}
    task = lesson_task("circle", "ordinary", clean | {"teaching.corrections_s": "28"} if IS_COMPILED else clean)
    counts = equal_lesson(task, 1).result.counts
    assert not IS_COMPILED or counts.presses
    assert not IS_COMPILED or task.teaching.supervised_s + 2.5 <= counts.teaching_s < task.teaching.duration_s


def test_stuck_robot_is_rescued_in_the_batch_as_on_the_bus() -> None:
    task = lesson_task("fleeing", "superhuman", BLIND_TEACHER | {"teaching.rescue_after_s": "2"})
    assert not IS_COMPILED or equal_lesson(task, 1).result.counts.rescues


def test_ticks_that_are_taken_back_leave_no_trace() -> None:
    task, hashes = lesson_task("circle", "superhuman"), []
    for detour in (0, 150):
        with batch_lesson(task, 3) as run:
            robot = run.robot
            robot.run(60 + detour)
            robot.restore_tick(60)
            robot.keep()
            hashes.append(robot.lesson_hash())
    assert hashes[0] == hashes[1]


def test_too_long_a_stretch_is_refused() -> None:
    task = lesson_task("circle", "superhuman")
    with batch_lesson(task, 3) as run, pytest.raises(ValueError, match="keep after 250"):
        run.robot.run(251)
