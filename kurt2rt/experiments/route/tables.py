"""Tables and pictures of the route study, and its report."""

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from kurt2rt.core.task_settings import PaperResult, TaskSettings
from kurt2rt.experiments.lockstep.drive_row import Place
from kurt2rt.experiments.lockstep.trails import draw_drive, legend_below, panels_of
from kurt2rt.experiments.route.route_monitor import LAYERS
from kurt2rt.experiments.route.study import RouteJob, RouteOutcome, Routes, RouteTasks
from kurt2rt.experiments.study.figures import SavedFigure, saved
from kurt2rt.experiments.study.intervals import Rate, right_rate
from kurt2rt.experiments.study.report import TO_SEE_LESSONS, spans, tell_with_report
from kurt2rt.experiments.study.study_plan import StudyPlan, read_groups
from kurt2rt.experiments.study.table import (
    Column,
    Table,
    Told,
    Verdict,
    collisions_text,
    middle,
    most,
    needed_of,
    of_text,
    quarters,
    reasons_against_judging,
    share,
    share_text,
    table_of,
    targets_table,
    to_text,
    total,
)
from kurt2rt.platform.drive_picture import ASKED, columns
from kurt2rt.platform.save_figure import save_figure
from simbridge.contracts.simulation import SimulationFactory

_ROUTE = "#e8a33d"
_MARKS = {"symbols": "v", "mid": "s", "basic": "o"}
_COLUMNS = 4
_BESIDE_M = 0.13
"""So far to the right of the middle of a street its way is drawn, so that both ways through it are seen."""


def draw_figures(routes: Sequence[Routes], factory: SimulationFactory, folder: Path) -> Iterator[SavedFigure]:
    """Draw each length into the folder and yield it: route-<decisions>.png. Raises OSError."""
    for decisions, outcomes in routes:
        yield saved(
            _routes(factory, outcomes),
            folder / f"route-{decisions}.png",
            f"Routes of {decisions} decisions",
            "Orange: the route of each robot with the number of each decision behind its junction; blue: its drive "
            "without a teacher; red: wrong decisions (triangle: symbols, square: mid level, circle: basic level); "
            "black: collisions.",
        )


def draw_route(factory: SimulationFactory, outcome: RouteOutcome, path: Path) -> None:
    """Draw the route of one robot with the numbers of its decisions, and the drive.

    Writes a PNG to `path`. Raises OSError.
    """
    figure, (axes,) = panels_of(1, 1, (7.2, 7.8))
    _draw(axes, factory, outcome)
    axes.set_title(_told(outcome), fontsize="medium")
    legend_below(axes)
    save_figure(figure, path)


def _routes(factory: SimulationFactory, outcomes: Sequence[RouteOutcome]) -> Figure:
    """Return a panel for each robot: route, decisions and drive."""
    figure, panels = panels_of(len(outcomes), _COLUMNS, (4.0, 4.4))
    for axes, outcome in zip(panels, outcomes, strict=True):
        _draw(axes, factory, outcome)
        axes.set_title(_told(outcome), fontsize="small")
    return figure


def _draw(axes: Axes, factory: SimulationFactory, outcome: RouteOutcome) -> None:
    # Questions are not drawn: wrong decisions have their colour.
    draw_drive(axes, factory, outcome.drive.model_copy(update={"asked_at": ()}))
    route = [*outcome.route, outcome.route[0]]
    label: str | None = f"the route, {len(outcome.route)} decisions"
    for number, (here, there) in enumerate(pairwise(route), start=1):
        (from_x, from_y), (to_x, to_y) = _beside(here, there)
        arrow = {"arrowstyle": "-|>", "color": _ROUTE, "linewidth": 2.4, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", (to_x, to_y), (from_x, from_y), arrowprops=arrow, zorder=2)
        place = (from_x + 0.14 * (to_x - from_x), from_y + 0.14 * (to_y - from_y))
        axes.annotate(str(number), place, fontsize="x-small", ha="center", va="center", zorder=7, bbox=_BOX)
    axes.plot([], [], color=_ROUTE, linewidth=2.4, label=label)
    for layer in LAYERS:
        wrong = [(each.x_m, each.y_m) for each in outcome.wrong if each.layer == layer]
        if wrong:
            label = f"wrong: {layer} ({len(wrong)})"
            axes.plot(*columns(wrong), _MARKS[layer], color=ASKED, markersize=7, zorder=5, label=label)


_BOX = {"boxstyle": "circle,pad=0.12", "facecolor": "white", "edgecolor": _ROUTE, "linewidth": 0.8}


def _beside(here: Place, there: Place) -> tuple[Place, Place]:
    """Return start and end of the way between two junctions, right of the middle of the street."""
    (from_x, from_y), (to_x, to_y) = here, there
    length_m = math.dist(here, there)
    along_x, along_y = (to_x - from_x) / length_m, (to_y - from_y) / length_m
    right_x, right_y = along_y * _BESIDE_M, -along_x * _BESIDE_M
    cut_m = 2 * _BESIDE_M
    return (
        (from_x + right_x + cut_m * along_x, from_y + right_y + cut_m * along_y),
        (to_x + right_x - cut_m * along_x, to_y + right_y - cut_m * along_y),
    )


def _told(outcome: RouteOutcome) -> str:
    drive = outcome.drive
    collisions = f", {collisions_text(drive.collisions)}" if drive.collisions else ""
    return (
        f"robot {outcome.seed}: {drive.right} of {drive.junctions} decisions right{collisions}\n"
        f"{drive.duration_s:.0f} s {'without an error' if drive.passed else 'with errors'}, "
        f"{outcome.lesson.mid_rlas} mid-level RLAs"
    )


WITHOUT_ERROR = {8: 18 / 20, 12: 18 / 20, 16: 15 / 20}
"""Share of the robots that are to drive to the end without an error, by decisions of the route."""
RIGHT = 0.99
"""Share of all decisions that is to be right."""
_LAYERS = (
    "Which layer failed: symbols: what the robot had noticed of junctions was not what it had done there; mid: it had "
    "noticed everything, and wanted something else or asked; basic: it was told what is right, and did not do it."
)


def _right_of(routes: Routes) -> Rate:
    """Return the share of the decisions that were right, with its interval; 0 without decisions."""
    return right_rate([each.drive for each in routes.rows]) or Rate(0.0, 0.0, 1.0)


def verdicts(routes: Routes, paper: PaperResult) -> Iterator[Verdict]:
    """Yield the verdicts on routes of one length, by the paper's results; none for other lengths."""
    decisions, outcomes = routes
    share = WITHOUT_ERROR.get(decisions)
    if share is None:
        return
    most = max(each.lesson.mid_rlas for each in outcomes)
    yield Verdict("mid-level RLAs, most", f"at most {paper.rlas}", str(most), most <= paper.rlas)
    longest_s = max(each.lesson.teaching_s for each in outcomes)
    yield Verdict("teaching", f"at most {paper.teaching_s:g} s", f"{longest_s:g} s", longest_s <= paper.teaching_s)
    right, junctions = _right_of(routes).value, sum(each.drive.junctions for each in outcomes)
    yield Verdict("decisions right", f"at least {RIGHT:.0%}", f"{right:.2%} of {junctions}", right >= RIGHT)
    needed, without = needed_of(share, len(outcomes)), sum(each.drive.passed for each in outcomes)
    asked, came = f"at least {of_text(needed, len(outcomes))}", of_text(without, len(outcomes))
    yield Verdict("drives without an error", asked, came, without >= needed)


def _length(routes: Routes) -> str:
    return f"{routes.of} decisions"


_LENGTH: Column = ("route", _length)


def all_tables(routes: Sequence[Routes], task: TaskSettings, seeds: Sequence[int]) -> Iterator[Table]:
    """Yield the tables of a study of routes, in the order of its report."""
    found = [((_length(each),), verdict) for each in routes for verdict in verdicts(each, task.paper)]
    if found:
        yield targets_table(found, list(reasons_against_judging(seeds)), headings=("route",))
    yield table_of(
        "What was taught",
        routes,
        _LENGTH,
        middle("mid-level RLAs", "lesson.mid_rlas"),
        quarters("lesson.mid_rlas"),
        most("teaching, s", "lesson.teaching_s"),
        middle("asks", "lesson.mid_asks"),
        middle("corrections", "lesson.mid_corrections"),
        middle("missed", "lesson.missed_junctions"),
        middle("basic RLAs", "lesson.rlas"),
        *(middle(name, f"lesson.{name}") for name in ("asks", "corrections", "rescues")),
        note=f"Medians of {len(seeds)} robots. Asks and corrections first of the mid level, then of the "
        "basic one. Missed: junctions that the mid level did not notice, where the teacher commanded. Robot time, "
        "without the streets, which were taught before. Taught by the scripted teacher "
        f"{task.teaching.profile.name}.",
    )
    yield _exam_table(routes, task)
    for each in routes:
        if len(routes) == 1 or len(each.rows) <= 2:
            yield table_of(
                f"Each robot: {_length(each)}",
                each.rows,
                ("robot", lambda robot: robot.seed),
                ("mid-level RLAs", lambda robot: robot.lesson.mid_rlas),
                ("asks", lambda robot: robot.lesson.mid_asks),
                ("corrections", lambda robot: robot.lesson.mid_corrections),
                ("right", lambda robot: of_text(robot.drive.right, robot.drive.junctions)),
                ("collisions", lambda robot: robot.drive.collisions),
                ("drive, s", lambda robot: f"{robot.drive.duration_s:.0f}"),
                ("errors", lambda robot: errors_of(robot) or "none"),
            )


def _exam_table(routes: Sequence[Routes], task: TaskSettings) -> Table:
    def failed(layer: str) -> Callable[[Routes], int]:
        return lambda each: sum(wrong.layer == layer for robot in each.rows for wrong in robot.wrong)

    def right(each: Routes) -> str:
        return f"{_right_of(each).value:.2%} of {sum(robot.drive.junctions for robot in each.rows)}"

    return table_of(
        "Drives without a teacher",
        routes,
        _LENGTH,
        share("without an error", "drive.passed"),
        ("95 %", lambda each: share_text(sum(robot.drive.passed for robot in each.rows), len(each.rows))),
        ("decisions right", right),
        ("95 %", lambda each: to_text(_right_of(each)[1:], ".1%")),
        *((layer, failed(layer)) for layer in LAYERS),
        total("collisions", "drive.collisions"),
        total("stuck", "drive.ended_early"),
        note=f"{task.exam.duration_s:g} s each. Without an error: every decision right, no "
        "collision, not stuck, not stopped by the guard. A robot that left its route is set down on it again, and "
        f"goes on; one that is stuck ends there. {_LAYERS}",
    )


def robot_table(outcome: RouteOutcome, task: TaskSettings) -> Table:
    """Return the table of one robot, with the paper's numbers."""
    drive, lesson, paper = outcome.drive, outcome.lesson, task.paper
    rows = (
        ("teacher", task.teaching.profile.name, "a person"),
        ("mid-level RLAs", str(outcome.lesson.mid_rlas), str(paper.rlas)),
        ("teaching, s of robot time", f"{lesson.teaching_s:.0f}", paper.teaching_time_text),
        ("questions of the mid level", str(outcome.lesson.mid_asks), ""),
        ("corrections of the mid level", str(outcome.lesson.mid_corrections), ""),
        ("junctions that it did not notice", str(outcome.lesson.missed_junctions), ""),
        ("RLAs of the basic level", str(lesson.rlas), ""),
        ("its questions", str(lesson.asks), ""),
        ("its corrections", str(lesson.corrections), ""),
        ("rescues by hand", str(lesson.rescues), ""),
        (f"drive without a teacher, s of {task.exam.duration_s:.0f}", f"{drive.duration_s:.0f}", ""),
        ("decisions right", of_text(drive.right, drive.junctions), ""),
        ("collisions", str(drive.collisions), ""),
        ("errors", errors_of(outcome) or "none", ""),
    )
    return Table(f"Route of {len(outcome.route)} decisions: robot {outcome.seed}", ("", "here", "paper"), rows)


def errors_of(outcome: RouteOutcome) -> str:
    """Return the errors of a drive with their times."""
    drive = outcome.drive
    said = [f"{each.layer} at {each.at_s:.0f} s (decision {each.leg + 1})" for each in outcome.wrong]
    said += [collisions_text(drive.collisions) if drive.collisions else "", "stuck" if drive.stuck else "", drive.alarm]
    return ", ".join(filter(None, said))


def tell(plan: StudyPlan[RouteTasks], command: str) -> Told:
    """Write pictures and report into the folder of the results; return the tables. Raises StudyError, OSError.

    `command`: typed words, without those that belong to the machine alone.
    """
    routes = read_groups(plan.of(RouteJob), lambda job: job.decisions, RouteOutcome)
    (task, basic), folder = plan.about, plan.results.folder
    tables, reasons = list(all_tables(routes, task, plan.seeds)), list(reasons_against_judging(plan.seeds))
    drives = [robot.drive for each in routes for robot in each.rows]
    without = of_text(sum(each.passed for each in drives), len(drives), interval=True)
    sentence = f"{without} robots drove their route without a teacher and without an error."
    about = (
        f"A simulated robot is taught the streets ({basic.teaching.duration_s:g} s), and then a fixed route through "
        f"them ({task.teaching.duration_s:g} s): a closed loop that its seed draws, at each of whose junctions one way "
        "is right. Its mid level is asked for nothing but which taught behaviour is next. Then it drives the route "
        f"without its teacher. Once per seed ({spans(plan.seeds)}); a seed makes the robot with the spread of its "
        "sensors, its noise and its route."
    )
    told = Told(tables, sentence, (about,), tables[0], reasons)
    pictures = list(draw_figures(routes, plan.jobs[0].factory, folder))
    title = "KURT2: routes that its mid level was taught"
    return tell_with_report(folder, title, told, command, pictures, footer=TO_SEE_LESSONS)
