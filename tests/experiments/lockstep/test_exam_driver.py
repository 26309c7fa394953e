"""Exams of a study in a batch, with witnesses on the CAN bus."""

from dataclasses import replace
from pathlib import Path

import anyio
import pytest

from kurt2rt.experiments.lockstep import curriculum
from kurt2rt.experiments.lockstep.batch_exam import examine_in_batch
from kurt2rt.experiments.lockstep.curriculum import WorldResult, run_exams
from kurt2rt.experiments.lockstep.exam import ExamResult
from kurt2rt.experiments.lockstep.exam_driver import (
    ON_BUS,
    BatchDiffersError,
    DriveLoop,
    ExamDriver,
    choose_drivers,
)
from kurt2rt.experiments.study.results import Results
from kurt2rt.experiments.study.seeds import SeedJob, SeedOutcome
from tests.experiments.helpers import ROBOT, STAGE, short_task
from tests.experiments.paper.outcomes import MADE_OF

BATCH = ExamDriver(DriveLoop.BATCH)
WATCHED = ExamDriver(DriveLoop.BATCH, frozenset("a"))


def witnesses(robots: int, worlds: str) -> int:
    return sum(len(driver.witnesses) for driver in choose_drivers(DriveLoop.BATCH, robots, list(worlds)))


def test_one_exam_in_a_hundred_has_a_witness_at_least_three() -> None:
    assert [witnesses(robots, "abc") for robots in (1, 20, 100, 201)] == [3, 3, 3, 7]
    assert witnesses(2, "a") == 2
    assert choose_drivers(DriveLoop.BUS, 2, ["a"]) == [ON_BUS, ON_BUS]


def examined(driver: ExamDriver, reported: list[str] | None = None) -> tuple[WorldResult, ...]:
    """Examine an untaught robot, which stands, and its teacher's policy."""

    async def run() -> tuple[WorldResult, ...]:
        def report(what: str, done_s: float, whole_s: float) -> None:
            if reported is not None and done_s == whole_s:
                reported.append(what)

        return await run_exams(
            STAGE, ROBOT, short_task(exam_s=1.0), (), ("a", "b"), seed=1, report=report, driver=driver
        )

    return anyio.run(run)


@pytest.mark.parametrize("driver", [BATCH, WATCHED])
def test_exams_in_a_batch_are_those_on_the_bus(driver: ExamDriver) -> None:
    reported: list[str] = []
    assert examined(driver, reported) == examined(ON_BUS)
    assert len(set(reported)) == 4


def test_robot_that_leaves_the_batch_is_examined_on_the_bus(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(curriculum, "examine_in_batch", lambda *_: [None] * 4)
    assert examined(BATCH) == examined(ON_BUS)


def test_witness_refuses_results_that_differ(monkeypatch: pytest.MonkeyPatch) -> None:
    def wrong(*given: object) -> list[ExamResult | None]:
        results = examine_in_batch(*given)  # type: ignore[arg-type]
        return [None if each is None else replace(each, progress=each.progress + 1e-12) for each in results]

    monkeypatch.setattr(curriculum, "examine_in_batch", wrong)
    with pytest.raises(BatchDiffersError, match=r"world a, seed 1: .* differ in progress"):
        examined(WATCHED)
    assert len(examined(BATCH)) == 2


def test_study_of_a_seed_examines_in_the_batch(tmp_path: Path) -> None:
    in_batch, on_bus = (
        SeedJob(
            factory=STAGE,
            robot=ROBOT,
            task=short_task(exam_s=1.0),
            seed=1,
            made_of=MADE_OF,
            results=Results(tmp_path / folder),
            driver=driver,
        )
        for folder, driver in (("batch", WATCHED), ("bus", ON_BUS))
    )
    for job in (in_batch, on_bus):
        job.results.folder.mkdir()
        job.run(lambda _: None)
    assert in_batch.results.read(in_batch, SeedOutcome) == on_bus.results.read(on_bus, SeedOutcome)
