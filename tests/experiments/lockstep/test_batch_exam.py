"""Exams in a batch have the results of exams on the CAN bus."""

import math
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import pytest

from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.lockstep.batch_exam import examine_in_batch
from kurt2rt.experiments.lockstep.exam import ExamSetup
from simbridge.batch.compiled import IS_COMPILED
from simbridge.contracts.batch import BatchRefusedError
from tests.experiments.helpers import ROBOT, STAGE, exam_on_bus, short_task, teach
from tests.simbridge.batch.equal_lessons import batch_lesson

EXAM_S = 15.0 if IS_COMPILED else 2.0


def exams_of(events: Sequence[TeachingEvent], worlds: Sequence[str], seeds: Sequence[int]) -> list[ExamSetup]:
    """Exams of a robot and of its teacher's policy."""
    return [
        ExamSetup(world, seed, policy, events=events) for world in worlds for seed in seeds for policy in (False, True)
    ]


def taught_shortly(name: str, *, plain: bool) -> TaskSettings:
    """Return a task with a short lesson and exam."""
    times = {"teaching.supervised_s": EXAM_S / 2, "teaching.corrections_s": EXAM_S, "exam.duration_s": EXAM_S}
    return load_task(name, paper_defaults=plain, changes={key: str(seconds) for key, seconds in times.items()})


def test_robot_that_is_stuck_ends_its_exam_early() -> None:
    task = short_task(exam_s=3.0, stuck_after_s=1.0)
    exam = ExamSetup("a", 1)
    (result,) = examine_in_batch(STAGE, ROBOT, task, [exam])
    assert result == exam_on_bus(task, exam)
    assert result is not None
    assert (result.stuck, result.duration_s, result.share_unknown) == (True, 1.01, 1.0)


def test_start_in_sight_is_that_of_the_bus() -> None:
    task = load_task("circle", changes={"exam.duration_s": "2", "exam.start": "in_sight"})
    exam = ExamSetup("one_object", 4, teacher_policy=True)
    assert examine_in_batch(STAGE, ROBOT, task, [exam]) == [exam_on_bus(task, exam)]


@pytest.mark.parametrize(
    ("name", "plain", "worlds"),
    [
        ("streets", False, ("manhattan", "streets-5")),
        pytest.param("straight_on", False, ("manhattan", "streets-5"), marks=pytest.mark.deep),
        ("wall_following", True, ("a", "b")),
        pytest.param("streets", True, ("manhattan", "streets-5"), marks=pytest.mark.deep),
    ],
)
def test_taught_robot_has_the_results_of_the_bus(name: str, plain: bool, worlds: Sequence[str]) -> None:
    task = taught_shortly(name, plain=plain)
    with batch_lesson(task, 2) as run:
        assert run.drive_stretches()
        events = run.given().events
    exams = [ExamSetup(world, 2, events=events) for world in worlds]
    results = examine_in_batch(STAGE, ROBOT, task, exams)
    for exam, result in zip(exams, results, strict=True):
        assert result is None or result == exam_on_bus(task, exam)


def test_robot_without_a_way_on_is_put_elsewhere_as_on_the_bus() -> None:
    # A policy that never turns comes to junctions that lead to the sides only.
    task = load_task("straight_on", changes={"exam.duration_s": "40" if IS_COMPILED else "2"})
    exam = ExamSetup("manhattan", 3, teacher_policy=True)
    (result,) = examine_in_batch(STAGE, ROBOT, task, [exam])
    assert result == exam_on_bus(task, exam)
    assert result is not None
    steps_m = [math.dist(a, b) for a, b in pairwise(result.trail)]
    assert not IS_COMPILED or max(steps_m) > 0.5


@pytest.mark.parametrize(
    ("name", "changes", "policy"),
    [
        ("route", {}, False),
        ("errands", {}, True),
        ("wall_following", {"learning.doubt.asks": "true", "learning.doubt.alone": "true"}, False),
    ],
)
def test_batch_refuses_tasks_that_it_does_not_know(name: str, changes: dict[str, str], policy: bool) -> None:
    task = load_task(name, changes=changes)
    with pytest.raises(BatchRefusedError, match="use the CAN bus"):
        examine_in_batch(STAGE, ROBOT, task, [ExamSetup(task.exam.worlds[0], 1, policy)])


@pytest.mark.deep
def test_hundred_exams_have_the_results_of_the_bus(tmp_path: Path) -> None:
    compared = 0
    for seed in range(5):
        lesson = short_task(supervised_s=60.0, corrections_s=120.0, exam_s=60.0)
        taught = teach(tmp_path / f"{seed}", lesson, seed)
        exams = exams_of(taught.events, ("a", "b", "c", f"rooms-{1000 + seed}", f"rooms-{1100 + seed}"), (1, 2))
        for exam, result in zip(exams, examine_in_batch(STAGE, ROBOT, taught.task, exams), strict=True):
            if result is not None:
                assert result == exam_on_bus(taught.task, exam)
                compared += 1
    assert compared >= 95
