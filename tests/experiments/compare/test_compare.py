"""A comparison on the simulated robot: the same robots, teacher and exams for all pupils."""

from dataclasses import replace
from pathlib import Path

import anyio
import numpy as np
import pytest
from numpy.typing import NDArray

from kurt2rt.core.learner.learner import Why
from kurt2rt.core.learner.learners import NoLearnerError
from kurt2rt.core.learner.rla_learner import RlaLearner
from kurt2rt.core.task_settings import TaskSettings, load_task, taught_by_named
from kurt2rt.experiments.compare import SHIPPED, Compared, Pupil, PupilJob, PupilOutcome, Row, make_plan, read_rows
from kurt2rt.experiments.lockstep.engine import ON_BUS, Engine, Engines
from kurt2rt.experiments.study.study_plan import StudyPlan
from tests.experiments.helpers import short_task
from tests.experiments.study.here import carry_out, parts_in

AFTER = (2, 5)
IN_BATCH = Engines(Engine.COMPILED, Engine.COMPILED)


class Breaking(RlaLearner):
    """Learner that fails in its fourth lesson."""

    lessons = 0

    def lesson(self, situation: NDArray[np.float64], action: str, why: Why) -> None:
        super().lesson(situation, action, why)
        self.lessons += 1
        if self.lessons == 4:
            raise RuntimeError("four are too many")


BREAKING = f"{__name__}:Breaking"


def plan_for(folder: Path, *pupils: Pupil) -> StudyPlan[Compared]:
    """Return a plan of short lessons and exams in world A."""
    return make_plan([short_task(exam_s=6.0)], pupils, (3902,), AFTER, parts_in(folder))


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> tuple[Row, ...]:
    folder = tmp_path_factory.mktemp("comparison")
    plan = plan_for(folder, Pupil("rla-door"), Pupil("weighted-vote"), Pupil(BREAKING))
    return read_rows(carry_out(plan, folder))


def test_each_pupil_is_examined_after_presses_and_at_the_end(done: tuple[Row, ...]) -> None:
    assert [each.of[1].name for each in done][:2] == [SHIPPED, "rla-door"]
    for each_row in done:
        (outcome,) = each_row.rows
        assert [each.presses for each in outcome.checkpoints[:-1]] == list(AFTER)
        assert outcome.lesson.presses == outcome.checkpoints[-1].presses
        assert outcome.failure or outcome.lesson.presses > AFTER[-1]
        seconds = [each.teaching_s for each in outcome.checkpoints]
        assert seconds == sorted(seconds)
        assert seconds[-1] == 15.0
        assert all(len(each.drives) == 1 for each in outcome.checkpoints)


@pytest.mark.parametrize("text", ["k-nn=wide", "rla=1", "no-such"])
def test_pupil_of_another_text_is_refused(text: str) -> None:
    with pytest.raises(NoLearnerError):
        Pupil.parse(text)


def require_equal(folder: Path, pupil: Pupil, task: TaskSettings, seed: int = 3903) -> PupilOutcome:
    """Require one outcome of the batch and the CAN bus, and return it."""
    job: PupilJob = make_plan([task], [pupil], (seed,), AFTER, parts_in(folder)).of(PupilJob)[-1]
    batch, bus = (
        anyio.run(replace(job, engines=loops).measure, folder / f"{place}.knowledge", lambda *_: None)
        for place, loops in enumerate((IN_BATCH, ON_BUS))
    )
    assert batch == bus
    return batch


@pytest.mark.parametrize("name", ["weighted-vote", pytest.param(SHIPPED, marks=pytest.mark.deep)])
def test_pupil_is_equal_in_batch_and_on_the_bus(name: str, tmp_path: Path) -> None:
    assert require_equal(tmp_path, Pupil(name), taught_by_named(short_task(exam_s=6.0), "ordinary")).lesson.presses > 2


def test_pupil_that_fails_is_driven_on_the_bus(tmp_path: Path) -> None:
    outcome = require_equal(tmp_path, Pupil(BREAKING), taught_by_named(short_task(exam_s=6.0), "ordinary"))
    assert outcome.failure.endswith("RuntimeError: four are too many")


@pytest.mark.deep
@pytest.mark.parametrize(
    ("name", "task"),
    [
        ("1-nn", "wall_following"),
        ("k-nn", "eight"),
        ("rla", "streets"),
        ("svm", "fleeing"),
        ("tree", "eight"),
        ("weighted-vote", "streets"),
    ],
)
def test_whole_lesson_of_a_pupil_is_equal(name: str, task: str, tmp_path: Path) -> None:
    taught = taught_by_named(load_task(task, changes={"exam.duration_s": "40"}), "ordinary")
    require_equal(tmp_path, Pupil(name), taught, seed=3904)
