"""Navigation study on the simulated robot: streets, goals, tables and figures."""

from dataclasses import dataclass
from pathlib import Path

import pytest
from matplotlib.image import imread

from hal.settings import SettingsError
from kurt2rt.core.rla.events import RlaCreated, SituationNamed
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.navigation.figures import draw_errands
from kurt2rt.experiments.navigation.guided_tour import navigation_settings
from kurt2rt.experiments.navigation.outcome import ErrandsOutcome
from kurt2rt.experiments.navigation.plan import NavigationPlan, make_plan, read_outcomes
from kurt2rt.experiments.navigation.tables import all_tables
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.plan import missing_time_s, run_missing
from kurt2rt.experiments.study.results import Results
from kurt2rt.knowledge.journal.journal import Journal
from tests.experiments.helpers import ROBOT, STAGE
from tests.experiments.study.here import HERE


def short(name: str, teaching_s: float, exam_s: float) -> TaskSettings:
    task = load_task(name, changes={"teaching.supervised_s": "0", "teaching.corrections_s": str(teaching_s)})
    return task.model_copy(update={"exam": task.exam.model_copy(update={"duration_s": exam_s})})


def a_programme(results: Results, streets_s: float, errands_s: float, exam_s: float) -> NavigationPlan:
    errands, streets = short("errands", errands_s, exam_s), short("streets", streets_s, 6.0)
    return make_plan(
        errands,
        streets,
        (1,),
        JobParts(factory=STAGE, robot=ROBOT, results=results),
        controls=True,
    )


@dataclass(frozen=True)
class Done:
    results: Results
    plan: NavigationPlan
    outcome: ErrandsOutcome


def carried_out(folder: Path, streets_s: float, errands_s: float, exam_s: float) -> Done:
    results = Results(folder)
    plan = a_programme(results, streets_s, errands_s, exam_s)
    with results.held():
        run_missing(plan, results, HERE, lambda _: None)
    (outcome,) = read_outcomes(plan, results)
    return Done(results, plan, outcome)


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> Done:
    return carried_out(tmp_path_factory.mktemp("errands"), 10.0, 10.0, 1.0)


def test_streets_and_errands_are_one_robots_knowledge(done: Done) -> None:
    (job,) = done.plan.jobs
    with Journal.read_only(job.knowledge) as journal:
        events = journal.events()
        assert MID in journal.binding.levels
    assert next(event.name for event in events if isinstance(event, SituationNamed)) == "home"
    ways = [event for event in events if isinstance(event, RlaCreated) and event.rla.level == MID]
    assert len(ways) == done.outcome.mid_rlas >= 1


def test_run_missing_skips_finished_jobs(done: Done) -> None:
    assert missing_time_s(done.plan, done.results) == 0.0


def test_plan_and_controls_are_sent_to_the_same_goals(done: Done) -> None:
    assert [run.how for run in done.outcome.runs] == ["planning", "chance", "first taught"]
    assert len({tuple(errand.goal for errand in run.errands) for run in done.outcome.runs}) == 1


def test_it_is_told_and_drawn(done: Done, tmp_path: Path) -> None:
    tables = list(all_tables([done.outcome], navigation_settings(done.plan.task), "ordinary"))
    assert len(tables) == 3
    assert "ordinary" in tables[1].note
    picture = tmp_path / "robot.png"
    draw_errands(STAGE, "manhattan", done.outcome, picture)
    assert imread(picture).shape[0] > 400


def test_a_task_without_errands_has_none_to_run() -> None:
    with pytest.raises(SettingsError, match=r"\broute\b.*\berrands\b"):
        navigation_settings(load_task("route"))


@pytest.mark.deep
def test_navigation_reaches_goals_without_demonstration(tmp_path: Path) -> None:
    done = carried_out(tmp_path, 1165.0, 800.0, 120.0)
    planned, by_chance, _ = done.outcome.runs
    assert len(planned.errands) == 20
    assert planned.good(2.0) >= 16
    assert planned.good(1.3) > by_chance.good(1.3) + 8
