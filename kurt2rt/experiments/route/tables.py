"""Tables of the route study, and its report."""

from collections.abc import Callable, Iterator, Sequence

from kurt2rt.core.task_settings import PaperResult, TaskSettings
from kurt2rt.experiments.route.figures import draw_figures
from kurt2rt.experiments.route.route_monitor import LAYERS
from kurt2rt.experiments.route.study import RouteJob, RouteOutcome, Routes, RouteTasks
from kurt2rt.experiments.study.intervals import Rate, right_rate
from kurt2rt.experiments.study.report import Section, spans, write_report
from kurt2rt.experiments.study.study_plan import StudyPlan, read_groups
from kurt2rt.experiments.study.table import (
    Column,
    Table,
    Told,
    collisions_text,
    middle,
    most,
    of_text,
    quarters,
    share,
    share_text,
    table_of,
    to_text,
    total,
)
from kurt2rt.experiments.study.targets import Verdict, needed_of, reasons_against_judging, targets_table

WITHOUT_ERROR = {8: 18 / 20, 12: 18 / 20, 16: 15 / 20}
"""Share of the robots that are to drive to the end without an error, by decisions of the route."""
RIGHT = 0.99
"""Share of all decisions that is to be right."""
_LAYERS = (
    "Which layer failed: symbols: what the robot had noticed of junctions was not what it had done there; mid: it had "
    "noticed everything, and wanted something else or asked; basic: it was told what is right, and did not do it."
)


def right_of(routes: Routes) -> Rate:
    """Return the share of the decisions that were right, with its interval; 0 without decisions."""
    return right_rate([each.drive for each in routes.rows]) or Rate(0.0, 0.0, 1.0)


def verdicts(routes: Routes, paper: PaperResult) -> Iterator[Verdict]:
    """Yield the verdicts on routes of one length, by the paper's results; none for other lengths."""
    decisions, outcomes = routes
    share = WITHOUT_ERROR.get(decisions)
    if share is None:
        return
    most = max(each.mid_rlas for each in outcomes)
    yield Verdict("mid-level RLAs, most", f"at most {paper.rlas}", str(most), most <= paper.rlas)
    longest_s = max(each.lesson.teaching_s for each in outcomes)
    yield Verdict("teaching", f"at most {paper.teaching_s:g} s", f"{longest_s:g} s", longest_s <= paper.teaching_s)
    right, junctions = right_of(routes).value, sum(each.drive.junctions for each in outcomes)
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
        middle("mid-level RLAs", "mid_rlas"),
        quarters("mid_rlas"),
        most("teaching, s", "lesson.teaching_s"),
        middle("asks", "mid_asks"),
        middle("corrections", "mid_corrections"),
        middle("missed", "missed_junctions"),
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
                ("mid-level RLAs", lambda robot: robot.mid_rlas),
                ("asks", lambda robot: robot.mid_asks),
                ("corrections", lambda robot: robot.mid_corrections),
                ("right", lambda robot: of_text(robot.drive.right, robot.drive.junctions)),
                ("collisions", lambda robot: robot.drive.collisions),
                ("drive, s", lambda robot: f"{robot.drive.duration_s:.0f}"),
                ("errors", lambda robot: errors_of(robot) or "none"),
            )


def _exam_table(routes: Sequence[Routes], task: TaskSettings) -> Table:
    def failed(layer: str) -> Callable[[Routes], int]:
        return lambda each: sum(wrong.layer == layer for robot in each.rows for wrong in robot.wrong)

    def right(each: Routes) -> str:
        return f"{right_of(each).value:.2%} of {sum(robot.drive.junctions for robot in each.rows)}"

    return table_of(
        "Drives without a teacher",
        routes,
        _LENGTH,
        share("without an error", "drive.passed"),
        ("95 %", lambda each: share_text(sum(robot.drive.passed for robot in each.rows), len(each.rows))),
        ("decisions right", right),
        ("95 %", lambda each: to_text(right_of(each)[1:], ".1%")),
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
        ("mid-level RLAs", str(outcome.mid_rlas), str(paper.rlas)),
        ("teaching, s of robot time", f"{lesson.teaching_s:.0f}", paper.teaching_time_text),
        ("questions of the mid level", str(outcome.mid_asks), ""),
        ("corrections of the mid level", str(outcome.mid_corrections), ""),
        ("junctions that it did not notice", str(outcome.missed_junctions), ""),
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
    (task, basic), seeds, folder = plan.about, spans(plan.seeds), plan.results.folder
    tables, reasons = list(all_tables(routes, task, plan.seeds)), list(reasons_against_judging(plan.seeds))
    path = folder / "report.html"
    told = (
        f"A simulated robot is taught the streets ({basic.teaching.duration_s:g} s), and then a fixed route through "
        f"them ({task.teaching.duration_s:g} s): a closed loop that its seed draws, at each of whose junctions one way "
        "is right. Its mid level is asked for nothing but which taught behaviour is next. Then it drives the route "
        f"without its teacher. Once per seed ({seeds}); a seed makes the robot with the spread of its sensors, its "
        "noise and its route."
    )
    write_report(
        path,
        "KURT2: routes that its mid level was taught",
        (
            Section("", (told,)),
            Section("Tables", tables=tables),
            Section("Drives", pictures=list(draw_figures(routes, plan.jobs[0].factory, folder))),
            Section("How this was made"),
        ),
        reasons=reasons,
        command=command,
        footer=f"Seeds {seeds}. {{versions}}. Source: {{source}}. One robot's lessons: `kurt2rt knowledge show` with a "
        "file of the folder `knowledge` next to this report.",
    )
    return Told(tables, reasons, {"report": path})
