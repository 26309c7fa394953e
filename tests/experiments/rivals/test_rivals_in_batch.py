"""Lessons and exams of rivals are equal in the batch and on the CAN bus, but for times of the machine."""

from dataclasses import replace
from pathlib import Path

import anyio
import numpy as np
import pytest
from numpy.typing import NDArray

from hal.batch import AskedMind
from hal.settings import Settings
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.task_settings import TaskSettings, load_task, taught_by_named
from kurt2rt.experiments.lockstep.batch_mind import build_drive_settings, feature_table
from kurt2rt.experiments.lockstep.drive_loop import ON_BUS, DriveLoop, DriveLoops
from kurt2rt.experiments.rivals.jobs import RivalJob
from kurt2rt.experiments.rivals.leagues import LeagueName, rows_of_league
from kurt2rt.experiments.rivals.outcome import RivalOutcome
from kurt2rt.experiments.rivals.plan import make_plan
from kurt2rt.experiments.rivals.rival import ASKS_AT_RANDOM, TUNED, Rival
from kurt2rt.experiments.rivals.signals.jobs import RewardedRivalJob
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.results import Results
from tests.experiments.helpers import ROBOT, STAGE, short_task
from tests.experiments.rivals.test_league import Breaking

IN_BATCH = DriveLoops(DriveLoop.BATCH, DriveLoop.BATCH)
IN_BATCH_TOO = [each for each in rows_of_league(LeagueName.PRESSES) if each not in (TUNED, ASKS_AT_RANDOM)]
"""Rows with a lesson in the batch: one row has settings of a tuning, and one counts ticks of the CAN loop."""


def short(exam_s: float = 6.0) -> TaskSettings:
    return taught_by_named(short_task(exam_s=exam_s), "ordinary")


def job_of(folder: Path, rival: Rival, task: TaskSettings, seed: int = 3903) -> RivalJob:
    """Return the job of a rival, whose judging policy has driven."""
    parts = JobParts(factory=STAGE, robot=ROBOT, results=Results(folder))
    plan = make_plan([task], [rival], (seed,), (2, 5), parts, source_of=lambda _: "tested")
    for each in plan.policy_jobs:
        replace(each, loops=IN_BATCH).run(lambda _: None)
    return next(job for job in plan.rival_jobs if job.rival == rival)


def measured(job: RivalJob, folder: Path, loops: DriveLoops) -> RivalOutcome:
    return anyio.run(replace(job, loops=loops).measure, folder / "knowledge", lambda *_: None)


def without_times(outcome: Settings, job: RivalJob) -> dict[str, object]:
    return outcome.model_dump(exclude=set(job.machine_times))


def require_equal(folder: Path, rival: Rival, task: TaskSettings, seed: int = 3903) -> RivalOutcome:
    """Require one outcome of both loops, and return it."""
    job = job_of(folder, rival, task, seed)
    batch, bus = (measured(job, folder, loops) for loops in (IN_BATCH, ON_BUS))
    assert without_times(batch, job) == without_times(bus, job)
    return batch


@pytest.mark.parametrize(
    "name", ["rla-acts", "weighted-vote", *(pytest.param(name, marks=pytest.mark.deep) for name in ("rla", "rla-vote"))]
)
def test_rival_is_equal_in_batch_and_on_the_bus(name: str, tmp_path: Path) -> None:
    outcome = require_equal(tmp_path, Rival(name), short())
    assert outcome.tick_p99_us is None  # it did not leave the batch
    assert outcome.presses > 2


def test_rival_that_fails_is_driven_on_the_bus(tmp_path: Path) -> None:
    outcome = require_equal(tmp_path, Rival(f"{Breaking.__module__}:{Breaking.__qualname__}"), short())
    assert outcome.failure.endswith("RuntimeError: four are too many")
    assert outcome.tick_p99_us is not None


@pytest.mark.deep
@pytest.mark.parametrize("task", ["wall_following", "fleeing", "eight", "streets"])
@pytest.mark.parametrize("name", IN_BATCH_TOO)
def test_whole_lesson_of_a_rival_is_equal(name: str, task: str, tmp_path: Path) -> None:
    taught = taught_by_named(load_task(task, changes={"exam.duration_s": "40"}), "ordinary")
    require_equal(tmp_path, Rival(name), taught, seed=3904)


def test_learners_of_rewards_get_all_rewards(tmp_path: Path) -> None:
    tamer, rlas = (job_of(tmp_path, Rival(name), short()) for name in ("tamer", "rla-rewarded"))
    assert isinstance(tamer, RewardedRivalJob)
    assert isinstance(rlas, RewardedRivalJob)
    assert (tamer.plan.times.most_blame, rlas.plan.times.most_blame) == (0, 100)


def test_error_of_a_python_mind_ends_the_drive() -> None:
    task = short()

    def choose(_behaviour: str, situation: NDArray[np.float64]) -> str:
        raise ZeroDivisionError(f"{len(situation)} numbers")

    definition = load_situation(task.situation, ROBOT.infrared.names)
    features = feature_table(definition, ROBOT, np.ones(definition.dimensions), task)
    simulation = STAGE.open("a", 3903, "exam")
    try:
        batch = STAGE.open_batch([simulation], [AskedMind(choose, features)], build_drive_settings(ROBOT, task))
        with pytest.raises(ZeroDivisionError, match=f"{definition.dimensions} numbers"):
            batch.drive([0], 10)
        assert batch.reason_to_leave(0)
    finally:
        simulation.close()
