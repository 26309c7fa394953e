"""A run of seconds: too short to teach anything, long enough to leave every kind of result."""

from dataclasses import dataclass
from pathlib import Path

from kurt2rt.experiments.paper.extent import Extent
from kurt2rt.experiments.paper.figures import draw_figures
from kurt2rt.experiments.paper.plan import PaperPlan, make_plan
from kurt2rt.experiments.paper.report import write_report
from kurt2rt.experiments.paper.settings import load_paper
from kurt2rt.experiments.paper.summary import PaperStudy, read_study
from kurt2rt.experiments.study.figure import SavedFigure
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.plan import run_missing
from kurt2rt.experiments.study.results import Results
from tests.experiments.helpers import ROBOT, STAGE
from tests.experiments.study.here import HERE

EXTENT = Extent(most_teaching_s=4.0, most_exam_s=1.0, most_unseen=1, most_radii=1, most_robots=1, most_growth_s=4.0)
COMMAND = "kurt2rt paper --seeds 100"


@dataclass(frozen=True)
class Tiny:
    results: Results
    plan: PaperPlan
    study: PaperStudy
    pictures: list[SavedFigure]
    report: Path


def tiny_plan(results: Results, *tasks: str) -> PaperPlan:
    paper = load_paper()
    return make_plan(
        paper,
        EXTENT,
        (100,),
        ("shipped", "plain"),
        JobParts(factory=STAGE, robot=ROBOT, results=results),
        tasks=tasks,
    )


def do_tiny(folder: Path) -> Tiny:
    results = Results(folder)
    plan = tiny_plan(results, "wall_following", "eight")
    with results.held():
        run_missing(plan, results, HERE, lambda _: None)
    study = read_study(plan, results)
    pictures = list(draw_figures(study, STAGE, folder))
    report = folder / "report.html"
    write_report(study, pictures, COMMAND, report)
    return Tiny(results, plan, study, pictures, report)
