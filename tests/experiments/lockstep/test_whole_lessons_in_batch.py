"""Whole lessons and their exams are equal in the batch and on the CAN bus."""

import pytest

from kurt2rt.core.task_settings import TaskSettings, load_task, taught_by
from kurt2rt.core.teacher_settings import load_teacher
from kurt2rt.experiments.lockstep.batch_exam import examine_in_batch
from kurt2rt.experiments.lockstep.exam import ExamSetup
from simbridge.batch.compiled import IS_COMPILED
from tests.experiments.helpers import ROBOT, STAGE, exam_on_bus
from tests.simbridge.batch.equal_lessons import IN_STREETS, TASKS, lesson_in_both

WHOLE = pytest.mark.skipif(not IS_COMPILED, reason="plain Python takes hours")


@pytest.mark.deep
@WHOLE
@pytest.mark.parametrize("seed", range(5010, 5014))
@pytest.mark.parametrize("teacher", ["superhuman", "ordinary"])
@pytest.mark.parametrize("name", ["circle_repositioned", *IN_STREETS])
def test_whole_lesson_and_exams_are_equal_in_the_batch(name: str, teacher: str, seed: int) -> None:
    assert_equal_on_the_bus(taught_by(load_task(name), load_teacher(teacher)), seed)


@pytest.mark.deep
@WHOLE
@pytest.mark.parametrize("seed", range(5010, 5012))
@pytest.mark.parametrize("teacher", ["superhuman", "ordinary"])
@pytest.mark.parametrize("name", TASKS)
def test_whole_lesson_of_the_plain_reading_is_equal(name: str, teacher: str, seed: int) -> None:
    assert_equal_on_the_bus(taught_by(load_task(name, paper_defaults=True), load_teacher(teacher)), seed)


def assert_equal_on_the_bus(task: TaskSettings, seed: int) -> None:
    """Check that a lesson and the exams of its robot are equal in the batch and on the CAN bus.

    A drive in which a watch would look closer at a sensor belongs on the CAN bus, and is left out.
    """
    lesson = lesson_in_both(task, seed)
    if lesson is None:
        return
    saved = lesson.result.saved
    exams = [ExamSetup(world, seed, events=lesson.events, saved=saved) for world in task.exam.worlds]
    for exam, result in zip(exams, examine_in_batch(STAGE, ROBOT, task, exams), strict=True):
        assert result is None or result == exam_on_bus(task, exam)
