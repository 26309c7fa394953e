"""Whole lessons and their exams are equal in the batch and on the CAN bus."""

import pytest

from kurt2rt.core.task_settings import load_task, taught_by
from kurt2rt.core.teacher_settings import load_teacher
from kurt2rt.experiments.lockstep.batch_exam import BatchExam, examine_in_batch
from kurt2rt.experiments.lockstep.exam import ExamSetup
from simbridge.batch.compiled import IS_COMPILED
from tests.experiments.helpers import ROBOT, STAGE, exam_on_bus
from tests.simbridge.batch.equal_lessons import IN_STREETS, TASKS, lesson_in_both

SEEDS = range(5010, 5014)


@pytest.mark.deep
@pytest.mark.skipif(not IS_COMPILED, reason="plain Python takes hours")
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("teacher", ["superhuman", "ordinary"])
@pytest.mark.parametrize(
    ("name", "plain"),
    [*((name, False) for name in (*IN_STREETS, "circle_repositioned")), *((name, True) for name in TASKS)],
)
def test_whole_lesson_and_exams_are_equal_in_the_batch(name: str, plain: bool, teacher: str, seed: int) -> None:
    task = taught_by(load_task(name, plain=plain), load_teacher(teacher))
    lesson = lesson_in_both(task, seed)
    if lesson is None:  # a watch would look closer at a sensor, so the robot belongs on the CAN bus
        return
    setups = [ExamSetup(world, seed, saved=lesson.result.saved) for world in task.exam.worlds]
    exams = [BatchExam(setup, lesson.events) for setup in setups]
    for exam, result in zip(exams, examine_in_batch(STAGE, ROBOT, task, exams), strict=True):
        assert result is None or result == exam_on_bus(task, exam)
