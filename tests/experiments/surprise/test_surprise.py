"""A robot that was taught is surprised where something is different, in the real simulator."""

from dataclasses import replace
from pathlib import Path

import pytest

from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.study.table import Table
from kurt2rt.experiments.surprise.drive import SurpriseCounts
from kurt2rt.experiments.surprise.jobs import SurpriseJob, surprise_table
from tests.experiments.helpers import ROBOT, STAGE, teach

QUIET = SurpriseCounts("nothing", 200, 4, 10, 0, 0, 0.0)


def test_surprise_table_has_a_row_for_each_difference() -> None:
    one = (QUIET, SurpriseCounts("set down elsewhere", 100, 20, 30, 10, 8, 0.05))
    other = (replace(QUIET, surprising=8), SurpriseCounts("set down elsewhere", 100, 10, 30, 10, 6, 0.15))
    table: Table = surprise_table([one, other])
    assert table.rows == (
        ("nothing", "400", "3.0 %", "2.0 to 4.0 %", "5.0 %", "", "0.0 %"),
        ("set down elsewhere", "200", "15.0 %", "10.0 to 20.0 %", "30.0 %", "70.0 %", "10.0 %"),
    )


@pytest.fixture(scope="module")
def taught(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, TaskSettings]:
    """Return knowledge and task of the streets, taught half as long as the task says."""
    task = load_task("streets")
    task = task.model_copy(update={"teaching": task.teaching.model_copy(update={"corrections_s": 540.0})})
    return teach(tmp_path_factory.mktemp("surprise") / "taught.knowledge", task, seed=3).knowledge, task


@pytest.mark.deep
def test_changes_are_more_surprising_than_known_ground(
    taught: tuple[Path, TaskSettings],
) -> None:
    knowledge, task = taught
    told: list[float] = []
    job = SurpriseJob(STAGE, ROBOT, task, knowledge, seed=3, learns_s=600.0, different_s=150.0)
    nothing, _, set_down, another = job.run(told.append)
    assert told[-1] == pytest.approx(job.robot_time_s)
    assert 0.005 < nothing.surprising / nothing.ends < 0.05
    assert set_down.surprising / set_down.ends > 2 * nothing.surprising / nothing.ends
    assert another.surprising / another.ends > 2 * nothing.surprising / nothing.ends
    assert set_down.surprising_first_ends > 0.5 * set_down.first_ends > 0


@pytest.mark.deep  # the same lesson twice, in tests/experiments/lockstep/test_training_phases.py, is not
def test_the_same_seed_gives_the_same_surprises(taught_shortly: SurpriseJob) -> None:
    assert taught_shortly.run(lambda _: None) == taught_shortly.run(lambda _: None)


@pytest.fixture
def taught_shortly(tmp_path: Path) -> SurpriseJob:
    task = load_task("streets")
    task = task.model_copy(
        update={"teaching": task.teaching.model_copy(update={"corrections_s": 1.0, "supervised_s": 12.0})}
    )
    knowledge = teach(tmp_path / "taught.knowledge", task, seed=3).knowledge
    return SurpriseJob(STAGE, ROBOT, task, knowledge, seed=3, learns_s=6.0, different_s=2.0)
