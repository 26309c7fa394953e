"""A run of seconds: too short to teach anything, long enough to leave every kind of result."""

from dataclasses import dataclass
from pathlib import Path

from kurt2rt.experiments.paper.extent import Extent
from kurt2rt.experiments.paper.figure_files import draw_pictures
from kurt2rt.experiments.paper.plan import PaperPlan, plan
from kurt2rt.experiments.paper.report import write_report
from kurt2rt.experiments.paper.settings import load_paper
from kurt2rt.experiments.paper.study import PaperStudy, conduct, read_study
from kurt2rt.experiments.study.figure import SavedFigure
from kurt2rt.experiments.study.results import Results
from tests.experiments.helpers import ROBOT, STAGE

EXTENT = Extent(most_teaching_s=4.0, most_exam_s=1.0, most_unseen=1, most_radii=1, most_robots=1, most_growth_s=4.0)
COMMAND = "kurt2rt paper --seeds 100"


@dataclass(frozen=True)
class Tiny:
    results: Results
    programme: PaperPlan
    study: PaperStudy
    pictures: list[SavedFigure]
    report: Path


def tiny_programme(results: Results, *tasks: str) -> PaperPlan:
    paper = load_paper()
    return plan(
        paper, EXTENT, (100,), ("shipped", "plain"), STAGE, ROBOT, results, source_of=lambda _: "tested", tasks=tasks
    )


def do_tiny(folder: Path) -> Tiny:
    results = Results(folder)
    programme = tiny_programme(results, "wall_following", "eight")
    with results.held():
        conduct(programme, results.missing(programme.jobs), 1, lambda _: None)
    study = read_study(programme, results)
    pictures = list(draw_pictures(study, STAGE, folder))
    report = folder / "report.html"
    write_report(study, pictures, COMMAND, report)
    return Tiny(results, programme, study, pictures, report)
