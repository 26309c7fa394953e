"""Route study on the simulated robot: streets, route, tables, figures and report."""

from dataclasses import dataclass
from pathlib import Path

import pytest
from matplotlib.image import imread

from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.route import study as module
from kurt2rt.experiments.route.study import (
    BasicJob,
    RouteJob,
    RouteOutcome,
    RouteTasks,
    basic_file,
    basic_task_of,
    lesson_plans,
    make_plan,
)
from kurt2rt.experiments.route.tables import tell
from kurt2rt.experiments.study.jobs import StudyError
from kurt2rt.experiments.study.pool import PoolProgress
from kurt2rt.experiments.study.study_plan import StudyPlan
from kurt2rt.experiments.study.table import Told
from tests.experiments.study.here import carry_out, parts_in
from tests.experiments.study.page import Page

COMMAND = "kurt2rt train --task route --seeds 1"


def short(task: TaskSettings, teaching_s: float) -> TaskSettings:
    teaching = task.teaching.model_copy(update={"supervised_s": 0.0, "corrections_s": teaching_s})
    exam = task.exam.model_copy(update={"duration_s": 3.0})
    return task.model_copy(update={"teaching": teaching, "exam": exam})


def plan_in(folder: Path, basic_folder: Path | None = None, teaching_s: float = 8.0) -> StudyPlan[RouteTasks]:
    route = short(load_task("route"), teaching_s)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(module, "basic_task_of", lambda _task: short(load_task("streets"), 10.0))
        return make_plan(route, (1,), (4,), parts_in(folder), basic_folder=basic_folder)


@dataclass(frozen=True)
class Done:
    folder: Path
    plan: StudyPlan[RouteTasks]
    told: Told
    progress: list[PoolProgress]

    @property
    def outcomes(self) -> list[RouteOutcome]:
        return [job.results.read(job, RouteOutcome) for job in self.plan.of(RouteJob)]


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> Done:
    folder, progress = tmp_path_factory.mktemp("routes"), list[PoolProgress]()
    plan = carry_out(plan_in(folder), folder, progress.append)
    return Done(folder, plan, tell(plan, COMMAND), progress)


def test_route_run_teaches_the_streets_once(done: Done) -> None:
    (basic,) = done.plan.of(BasicJob)
    assert basic.knowledge.is_file()
    (taught,) = done.outcomes
    assert taught.lesson.teaching_s == 8.0
    assert taught.lesson.mid_rlas == taught.lesson.mid_asks > 0
    assert done.progress[-1].done_s == 10.0 + 8.0 + 3.0


def test_lesson_begun_again_goes_on_with_its_phases() -> None:
    times = {"teaching.supervised_s": "100", "teaching.corrections_s": "300"}
    plans = lesson_plans(load_task("route", changes=times), 2)
    assert plans[0].phases == ((Phase.SUPERVISED, 100.0), (Phase.CORRECTIONS, 100.0))
    assert plans[1].phases == ((Phase.CORRECTIONS, 200.0),)
    assert len({plan.purpose for plan in plans}) == 2


def test_basic_folder_skips_the_streets(done: Done, tmp_path: Path) -> None:
    folder = done.plan.of(BasicJob)[0].knowledge.parent
    plan = plan_in(tmp_path, folder)
    assert {each.basic for each in plan.of(RouteJob)} == {folder / "streets-1.knowledge"}
    assert len(plan.jobs) == 1
    basic = basic_task_of(load_task("route"))
    assert basic.name == "streets"
    assert basic_file(folder / "streets-1.knowledge", basic, 1) == folder / "streets-1.knowledge"
    with pytest.raises(StudyError, match=r"streets-2\.knowledge: "):
        basic_file(folder, basic, 2)


def test_pictures_and_report_show_each_length(done: Done) -> None:
    assert imread(done.folder / "route-4.png").std() > 0.01
    text = (done.folder / "report.html").read_text(encoding="utf-8")
    assert Page(text).images == ["Routes of 4 decisions"]
    assert COMMAND in text
    assert "<code>kurt2rt knowledge show</code>" in text
    assert all(table.title in text for table in done.told.tables)
