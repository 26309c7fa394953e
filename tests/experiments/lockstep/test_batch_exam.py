"""Exams in a batch have the results of exams on the CAN bus."""

from collections.abc import Sequence
from contextlib import closing
from pathlib import Path

import anyio
import pytest

from hal.batch_refusal import BatchRefusedError
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.lockstep.batch_exam import BatchExam, examine_in_batch
from kurt2rt.experiments.lockstep.exam import ExamResult, ExamSetup, examine
from simbridge.batch.compiled import IS_COMPILED
from simbridge.simulation import Kurt2SimulationFactory
from tests.experiments.helpers import ROBOT, STAGE, short_task, teach

EXAM_S = 40.0 if IS_COMPILED else 2.0


def on_bus(task: TaskSettings, exam: BatchExam) -> ExamResult:
    """Return the result on the CAN bus."""
    with closing(STAGE.open(exam.setup.world, exam.setup.seed, "exam")) as simulation:
        return anyio.run(examine, simulation, ROBOT, task, exam.events, exam.setup, lambda _: None)


def exams_of(events: Sequence[TeachingEvent], worlds: Sequence[str], seeds: Sequence[int]) -> list[BatchExam]:
    """Exams of a robot and of its teacher's policy."""
    return [
        BatchExam(ExamSetup(world, seed, policy), events)
        for world in worlds
        for seed in seeds
        for policy in (False, True)
    ]


def test_results_are_those_of_the_bus(tmp_path: Path) -> None:
    taught = teach(tmp_path / "k", short_task(exam_s=EXAM_S))
    exams = exams_of(taught.events, ("a", "c"), (1,))
    results = examine_in_batch(STAGE, ROBOT, taught.task, exams)
    assert any(results)
    for exam, result in zip(exams, results, strict=True):
        assert result is None or result == on_bus(taught.task, exam)


def test_robot_that_is_stuck_ends_its_exam_early() -> None:
    task = short_task(exam_s=3.0, stuck_after_s=1.0)
    exam = BatchExam(ExamSetup("a", 1))
    (result,) = examine_in_batch(STAGE, ROBOT, task, [exam])
    assert result == on_bus(task, exam)
    assert result is not None
    assert (result.stuck, result.duration_s, result.share_unknown) == (True, 1.01, 1.0)


def test_start_in_sight_is_that_of_the_bus() -> None:
    task = load_task("circle", changes={"exam.duration_s": "2", "exam.start": "in_sight"})
    exam = BatchExam(ExamSetup("one_object", 4, teacher_policy=True))
    assert examine_in_batch(STAGE, ROBOT, task, [exam]) == [on_bus(task, exam)]


@pytest.mark.parametrize(
    ("name", "changes", "policy"),
    [
        ("streets", {}, False),
        ("turn_left", {}, True),
        ("wall_following", {"learning.past_weight": "0.5"}, False),
        ("wall_following", {"learning.doubt.asks": "true", "learning.doubt.alone": "true"}, False),
    ],
)
def test_batch_refuses_tasks_that_it_does_not_know(name: str, changes: dict[str, str], policy: bool) -> None:
    task = load_task(name, changes=changes)
    with pytest.raises(BatchRefusedError, match="use the CAN bus"):
        examine_in_batch(STAGE, ROBOT, task, [BatchExam(ExamSetup(task.exam.worlds[0], 1, policy))])


def test_batch_over_a_wire_is_refused() -> None:
    exam = BatchExam(ExamSetup("a", 1, teacher_policy=True))
    with pytest.raises(BatchRefusedError, match="no wire"):
        examine_in_batch(Kurt2SimulationFactory(ROBOT, "lossy"), ROBOT, short_task(), [exam])


@pytest.mark.deep
def test_hundred_exams_have_the_results_of_the_bus(tmp_path: Path) -> None:
    compared = 0
    for seed in range(5):
        lesson = short_task(supervised_s=60.0, corrections_s=120.0, exam_s=60.0)
        taught = teach(tmp_path / f"{seed}", lesson, seed)
        exams = exams_of(taught.events, ("a", "b", "c", f"rooms-{1000 + seed}", f"rooms-{1100 + seed}"), (1, 2))
        for exam, result in zip(exams, examine_in_batch(STAGE, ROBOT, taught.task, exams), strict=True):
            if result is not None:
                assert result == on_bus(taught.task, exam)
                compared += 1
    assert compared >= 95
