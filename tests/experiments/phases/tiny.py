"""A run of seconds: too short to teach anything, long enough to leave every kind of result."""

from dataclasses import dataclass
from pathlib import Path

from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.phases.figures import draw_figures
from kurt2rt.experiments.phases.plan import PhasesPlan, make_plan
from kurt2rt.experiments.phases.report import reasons_not_to_judge, write_report
from kurt2rt.experiments.phases.summary import PhasesStudy, read_study
from kurt2rt.experiments.study.figure import SavedFigure
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.plan import run_missing
from kurt2rt.experiments.study.results import Results
from tests.experiments.helpers import ROBOT, STAGE
from tests.experiments.study.here import HERE

COMMAND = "kurt2rt phases --task wall_following --seeds 100"


@dataclass(frozen=True)
class Tiny:
    results: Results
    plan: PhasesPlan
    study: PhasesStudy
    pictures: list[SavedFigure]
    report: Path
    reasons: list[str]


def tiny_task() -> TaskSettings:
    task = load_task("wall_following")
    assert task.phases is not None
    teaching = task.teaching.model_copy(update={"supervised_s": 4.0, "corrections_s": 1.0})
    exam = task.exam.model_copy(update={"worlds": ("a",), "duration_s": 0.5})
    phases = task.phases.shortened(1.0, ("a",), 1.0, 0.5).model_copy(update={"critic_s": 4.0, "set_down_every_s": 2.0})
    return task.model_copy(update={"teaching": teaching, "exam": exam, "phases": phases})


def tiny_plan(results: Results) -> PhasesPlan:
    return make_plan(tiny_task(), (100,), JobParts(factory=STAGE, robot=ROBOT, results=results))


def do_tiny(folder: Path) -> Tiny:
    results = Results(folder)
    plan = tiny_plan(results)
    with results.held():
        run_missing(plan, results, HERE, lambda _: None)
    study = read_study(plan, results)
    pictures = list(draw_figures(study, folder))
    report = folder / "report.html"
    write_report(study, pictures, COMMAND, report)
    return Tiny(results, plan, study, pictures, report, list(reasons_not_to_judge(plan)))
