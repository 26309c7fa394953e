"""Route study on the simulated robot: streets, route, tables, figures and report."""

import re
from dataclasses import dataclass
from pathlib import Path

import pytest
from matplotlib.image import imread

from kurt2rt.core.rla.rla import MID
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.route.figures import draw_figures
from kurt2rt.experiments.route.plan import RoutePlan, basic_file, basic_task_of, make_plan
from kurt2rt.experiments.route.report import write_report
from kurt2rt.experiments.route.summary import RouteStudy, read_study
from kurt2rt.experiments.route.tables import all_tables
from kurt2rt.experiments.route.variants import CONTROLS, TAUGHT
from kurt2rt.experiments.study.figure import SavedFigure
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.plan import missing_time_s, run_missing
from kurt2rt.experiments.study.pool import PoolProgress
from kurt2rt.experiments.study.results import Results, StudyError
from kurt2rt.knowledge.journal.fold import fold_journal
from kurt2rt.knowledge.journal.journal import Journal
from tests.experiments.helpers import ROBOT, STAGE
from tests.experiments.study.here import HERE
from tests.experiments.study.page import Page

COMMAND = "kurt2rt lesson route --seeds 1"
VARIANTS = (TAUGHT, next(each for each in CONTROLS if each.name == "commanded"))


def short(task: TaskSettings, teaching_s: float) -> TaskSettings:
    teaching = task.teaching.model_copy(update={"supervised_s": 0.0, "corrections_s": teaching_s})
    exam = task.exam.model_copy(update={"duration_s": 3.0})
    return task.model_copy(update={"teaching": teaching, "exam": exam})


def a_programme(results: Results, basic_folder: Path | None = None, teaching_s: float = 8.0) -> RoutePlan:
    route, streets = short(load_task("route"), teaching_s), short(load_task("streets"), 10.0)
    return make_plan(
        route,
        streets,
        (1,),
        (4,),
        VARIANTS,
        JobParts(factory=STAGE, robot=ROBOT, results=results),
        basic_folder=basic_folder,
    )


@dataclass(frozen=True)
class Done:
    results: Results
    plan: RoutePlan
    study: RouteStudy
    pictures: list[SavedFigure]
    report: Path
    progress: list[PoolProgress]


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> Done:
    results = Results(tmp_path_factory.mktemp("routes"))
    plan = a_programme(results)
    progress: list[PoolProgress] = []
    with results.held():
        run_missing(plan, results, HERE, progress.append)
    study = read_study(plan, results)
    pictures = list(draw_figures(study, STAGE, results.folder))
    report = results.folder / "report.html"
    write_report(study, pictures, COMMAND, report)
    return Done(results, plan, study, pictures, report, progress)


def test_route_run_teaches_the_streets_once(done: Done) -> None:
    (basic,) = done.plan.basic_jobs
    assert basic.knowledge.is_file()
    taught, commanded = (summary.outcomes[0] for summary in done.study.summaries)
    assert (taught.teaching_s, commanded.teaching_s) == (8.0, 8.0)
    assert taught.mid_rlas == taught.mid_asks > 0 == commanded.mid_rlas
    assert done.results.missing(done.plan.jobs) == []
    assert done.progress[-1].done_s == 10.0 + 2 * (8.0 + 3.0)


def test_route_run_stores_the_mid_level(done: Done) -> None:
    job = done.plan.experiments[0].jobs[0]
    with Journal.read_only(job.knowledge) as journal:
        system = fold_journal(journal, job.task.learning.radius)
        assert journal.binding.system == "streets"
        assert journal.binding.levels[MID].feature_names[0] == "symbol 1"
    outcome = done.study.summaries[0].outcomes[0]
    assert len(system.rlas_at(MID)) == outcome.mid_rlas
    assert len(system.rlas) == outcome.basic_rlas
    assert system.knowledge_hash() == outcome.knowledge_hash


def test_route_run_repeated_does_nothing(done: Done) -> None:
    again = a_programme(done.results)
    assert missing_time_s(again, done.results) == 0.0
    with pytest.raises(StudyError, match=re.escape(f"{done.results.folder}: ")):
        done.results.missing(a_programme(done.results, teaching_s=13.0).jobs)


def test_basic_folder_skips_the_streets(done: Done, tmp_path: Path) -> None:
    folder = done.plan.basic_jobs[0].knowledge.parent
    plan = a_programme(Results(tmp_path), folder)
    assert plan.basic_jobs == ()
    assert plan.experiments[0].jobs[0].basic == folder / "streets-1.knowledge"
    assert basic_file(folder / "streets-1.knowledge", plan.basic, 1) == folder / "streets-1.knowledge"
    with pytest.raises(StudyError, match=r"streets-2\.knowledge: "):
        basic_file(folder, plan.basic, 2)


def test_pictures_and_report_show_every_way_of_teaching(done: Done) -> None:
    assert [each.path.name for each in done.pictures] == ["route-taught-4.png", "route-commanded-4.png"]
    for each in done.pictures:
        assert imread(each.path).std() > 0.01
    text = done.report.read_text(encoding="utf-8")
    assert Page(text).images == [each.title for each in done.pictures]
    assert COMMAND in text
    for table in all_tables(done.study):
        assert table.title in text


def test_basic_task_of_is_the_named_system() -> None:
    assert basic_task_of(load_task("route")).name == "streets"
