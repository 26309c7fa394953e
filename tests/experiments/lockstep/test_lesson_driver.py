"""Lessons of a study in a batch, with witnesses on the CAN bus."""

from dataclasses import replace
from pathlib import Path

import anyio
import pytest

from hal.batch_refusal import BatchRefusedError
from kurt2rt.core.task_settings import TaskSettings, load_task, taught_by
from kurt2rt.core.teacher_settings import load_teacher
from kurt2rt.experiments.lockstep import curriculum
from kurt2rt.experiments.lockstep.batch_lesson import teach_in_batch
from kurt2rt.experiments.lockstep.batch_lesson_settings import require_known_lesson
from kurt2rt.experiments.lockstep.curriculum import run_lesson
from kurt2rt.experiments.lockstep.exam_driver import BatchDiffersError, DriveLoop
from kurt2rt.experiments.lockstep.lesson_driver import (
    LESSON_ON_BUS,
    GivenLesson,
    LessonDriver,
    choose_lesson_drivers,
)
from kurt2rt.experiments.lockstep.lesson_plan import plan_of
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.plan import run_missing
from kurt2rt.experiments.study.results import Results
from kurt2rt.experiments.study.seeds import make_plan, read_results
from tests.experiments.helpers import ROBOT, STAGE, short_task

BATCH = LessonDriver(DriveLoop.BATCH)
WITNESSED = LessonDriver(DriveLoop.BATCH, is_witnessed=True)
TASK = short_task(supervised_s=3.0, corrections_s=1.0, exam_s=1.0)


def lesson(file: Path, driver: LessonDriver, task: TaskSettings = TASK) -> GivenLesson:
    async def run() -> GivenLesson:
        return GivenLesson(*await run_lesson(STAGE, ROBOT, task, file, seed=1, report=lambda *_: None, driver=driver))

    return anyio.run(run)


def test_one_lesson_in_a_hundred_has_a_witness_at_least_three() -> None:
    counts = [
        sum(each.is_witnessed for each in choose_lesson_drivers(DriveLoop.BATCH, lessons))
        for lessons in (1, 20, 300, 301)
    ]
    assert counts == [1, 3, 3, 4]
    assert choose_lesson_drivers(DriveLoop.BUS, 2) == [LESSON_ON_BUS, LESSON_ON_BUS]


@pytest.mark.parametrize("driver", [BATCH, WITNESSED])
def test_file_of_a_lesson_in_a_batch_is_that_of_the_bus(driver: LessonDriver, tmp_path: Path) -> None:
    batch, bus = lesson(tmp_path / "batch", driver), lesson(tmp_path / "bus", LESSON_ON_BUS)
    assert batch.events
    assert batch.events == bus.events
    assert batch.result.saved == bus.result.saved


def test_robot_that_leaves_the_batch_is_taught_on_the_bus(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(curriculum, "teach_in_batch", lambda *_given, **_named: None)
    assert lesson(tmp_path / "k", BATCH).events == lesson(tmp_path / "bus", LESSON_ON_BUS).events


def test_witness_refuses_a_lesson_that_differs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def wrong(*given: object, **named: object) -> GivenLesson | None:
        true = teach_in_batch(*given, **named)  # type: ignore[arg-type]
        return true and replace(true, events=true.events[:-1])

    monkeypatch.setattr(curriculum, "teach_in_batch", wrong)
    with pytest.raises(BatchDiffersError, match="differ in lessons"):
        lesson(tmp_path / "k", WITNESSED)


def test_batch_refuses_to_go_on_from_knowledge(tmp_path: Path) -> None:
    lesson(tmp_path / "k", BATCH)
    with pytest.raises(BatchRefusedError, match="knowledge to go on from"):
        lesson(tmp_path / "k", BATCH)


def test_batch_refuses_another_plan(tmp_path: Path) -> None:
    async def run() -> None:
        plan = replace(plan_of(TASK), most_presses=3)
        await run_lesson(STAGE, ROBOT, TASK, tmp_path / "k", seed=1, report=lambda *_: None, plan=plan, driver=BATCH)

    with pytest.raises(BatchRefusedError, match="a plan of its own"):
        anyio.run(run)


@pytest.mark.parametrize(
    ("task", "why"),
    [
        (load_task("route"), "course route"),
        (load_task("wall_following", changes={"learning.doubt.asks": "true"}), "asks at a doubt"),
        (load_task("wall_following", changes={"teaching.teacher.delete_after": "2"}), "deletes RLAs"),
    ],
)
def test_batch_refuses_lessons_that_it_does_not_know(task: TaskSettings, why: str) -> None:
    with pytest.raises(BatchRefusedError, match=why):
        require_known_lesson(ROBOT, task)


def test_batch_refuses_a_teacher_who_drives_by_hand() -> None:
    profile = load_teacher("ordinary")
    shows = profile.model_copy(update={"shows": profile.shows.model_copy(update={"times": 1})})
    with pytest.raises(BatchRefusedError, match="drives by hand"):
        require_known_lesson(ROBOT, taught_by(load_task("circle"), shows))


def test_study_of_a_seed_teaches_in_the_batch(tmp_path: Path) -> None:
    outcomes = []
    for loop in DriveLoop:
        results = Results(tmp_path / loop)
        parts = JobParts(factory=STAGE, robot=ROBOT, results=results)
        plan = make_plan({"": TASK}, [1], parts, wire="none", lessons=loop, source_of=lambda _: "tested")
        with results.held():
            run_missing(plan, results, 1, lambda _: None)
        outcomes.append(read_results(plan, results))
    assert outcomes[0] == outcomes[1]
