"""Navigation study on the simulated robot: streets, goals, tables and figures."""

from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

import anyio
import pytest
from matplotlib.image import imread

from config.settings import SettingsError
from kurt2rt.core.rla.events import RlaCreated, SituationNamed
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.task_settings import TaskSettings, load_task, taught_by_named
from kurt2rt.experiments.lockstep.lesson_keeping import lessons_kept
from kurt2rt.experiments.navigation import study as module
from kurt2rt.experiments.navigation.guided_tour import guided_tour, navigation_settings
from kurt2rt.experiments.navigation.study import ErrandsOutcome, NavigationJob, make_plan, tell
from kurt2rt.experiments.study.jobs import Results
from kurt2rt.experiments.study.study_plan import StudyPlan
from kurt2rt.knowledge.journal.journal import Journal
from tests.experiments.helpers import ROBOT, STAGE
from tests.experiments.study.here import carry_out, parts_in


def short(name: str, teaching_s: float, exam_s: float) -> TaskSettings:
    task = load_task(name, changes={"teaching.supervised_s": "0", "teaching.corrections_s": str(teaching_s)})
    return task.model_copy(update={"exam": task.exam.model_copy(update={"duration_s": exam_s})})


@dataclass(frozen=True)
class Done:
    plan: StudyPlan[TaskSettings]
    job: NavigationJob
    outcome: ErrandsOutcome


def carried_out(folder: Path, streets_s: float, errands_s: float, exam_s: float) -> Done:
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(module, "basic_task_of", lambda _task: short("streets", streets_s, 6.0))
        plan = make_plan(short("errands", errands_s, exam_s), (1,), parts_in(folder))
    (job,) = carry_out(plan, folder).of(NavigationJob)
    return Done(plan, job, Results(folder).read(job, ErrandsOutcome))


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> Done:
    return carried_out(tmp_path_factory.mktemp("errands"), 10.0, 10.0, 1.0)


def test_streets_and_errands_are_one_robots_knowledge(done: Done) -> None:
    with Journal.read_only(done.job.knowledge) as journal:
        events = journal.events()
        assert MID in journal.binding.levels
    assert next(event.name for event in events if isinstance(event, SituationNamed)) == "home"
    ways = [event for event in events if isinstance(event, RlaCreated) and event.rla.level == MID]
    assert len(ways) == done.outcome.mid_rlas >= 1


def test_it_is_told_and_drawn(done: Done) -> None:
    told = tell(done.plan, "")
    assert len(told.tables) == 3
    assert done.plan.about.teaching.profile.name in told.tables[1].note
    assert imread(done.plan.results.folder / "errands-1.png").shape[0] > 400


def test_a_task_without_errands_has_none_to_run() -> None:
    with pytest.raises(SettingsError, match=r"\broute\b.*\berrands\b"):
        navigation_settings(load_task("route"))


@pytest.mark.deep
def test_navigation_reaches_goals_without_demonstration(tmp_path: Path) -> None:
    done = carried_out(tmp_path, 1165.0, 800.0, 120.0)
    assert len(done.outcome.errands) == 20
    assert done.outcome.good(2.0) >= 16


def test_guided_tour_counts_the_holds_of_a_person_as_corrections(tmp_path: Path) -> None:
    task = taught_by_named(load_task("errands", changes={"teaching.corrections_s": "30"}), "ordinary")

    async def lead() -> int:
        with (
            lessons_kept(tmp_path / "town.knowledge", ROBOT, task) as keeping,
            closing(STAGE.open("manhattan", 1, "errands")) as simulation,
        ):
            led = await guided_tour(simulation, ROBOT, task, keeping.training, seed=1, on_progress=lambda _done_s: None)
            return led.counts.corrections

    assert anyio.run(lead) > 0
