"""One HTML file that holds everything: tables, pictures of the drives, and how it was made."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from hal.simulation import SimulationFactory
from kurt2rt.experiments.route.figures import draw_routes
from kurt2rt.experiments.route.summary import RouteStudy
from kurt2rt.experiments.route.tables import sheets
from kurt2rt.experiments.study.eligibility import reasons_of_robots
from kurt2rt.experiments.study.figure import SavedFigure
from kurt2rt.experiments.study.html_report import spans, write_page

_TITLE = "KURT2: routes that its mid level was taught"


def draw_pictures(study: RouteStudy, stage: SimulationFactory, folder: Path) -> Iterator[SavedFigure]:
    """Draw each length and way of teaching into the folder: route-<way>-<decisions>.png."""
    world = study.programme.task.exam.worlds[0]
    for summary in study.summaries:
        variant, decisions = summary.experiment.variant, summary.experiment.decisions
        path = folder / f"route-{variant.name}-{decisions}.png"
        draw_routes(stage, world, summary.outcomes, path)
        yield SavedFigure(
            path,
            f"Routes of {decisions} decisions: {variant.title}",
            "Orange: the route of each robot with the number of each decision behind its junction; blue: its drive "
            "without a teacher; red: wrong decisions (triangle: symbols, square: mid level, circle: basic level); "
            "black: collisions.",
        )


def write_report(study: RouteStudy, pictures: Sequence[SavedFigure], command: str, path: Path) -> None:
    """Write the report. `command`: what was typed, without what belongs to the machine alone. Raises OSError."""
    programme = study.programme
    write_page(
        path,
        "kurt2rt.experiments.route",
        "report.html.j2",
        _TITLE,
        pictures,
        reasons=list(reasons_of_robots(programme.seeds)),
        seeds=spans(programme.seeds),
        sheets=list(sheets(study)),
        basic_s=programme.basic.teaching.duration_s,
        teaching_s=programme.task.teaching.duration_s,
        command=command,
        source=programme.source,
    )
