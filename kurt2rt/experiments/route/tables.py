"""Tables of the route study, and its report."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from kurt2rt.core.task_settings import PaperResult, TaskSettings
from kurt2rt.experiments.route.route_monitor import LAYERS
from kurt2rt.experiments.route.study import RouteJob, RouteOutcome, RouteTasks
from kurt2rt.experiments.study.figures import SavedFigure
from kurt2rt.experiments.study.intervals import Rate, quartiles, right_rate
from kurt2rt.experiments.study.report import Section, spans, write_report
from kurt2rt.experiments.study.study_plan import Group, StudyPlan, read_groups
from kurt2rt.experiments.study.table import Table, collisions_text, median, of_text, share_text, table_of, to_text
from kurt2rt.experiments.study.targets import Verdict, needed_of, reasons_against_judging, targets_table

WITHOUT_ERROR = {8: 18 / 20, 12: 18 / 20, 16: 15 / 20}
"""Share of the robots that are to drive to the end without an error, by decisions of the route."""
RIGHT = 0.99
"""Share of all decisions that is to be right."""
_LAYERS = (
    "Which layer failed: symbols: what the robot had noticed of junctions was not what it had done there; mid: it had "
    "noticed everything, and wanted something else or asked; basic: it was told what is right, and did not do it."
)
Routes = Group[int, RouteOutcome]
"""Robots that were taught routes of one number of decisions."""


@dataclass(frozen=True, slots=True)
class RouteStudy:
    """Plan and outcomes of the study."""

    plan: StudyPlan[RouteTasks]
    routes: tuple[Routes, ...]


def read_study(plan: StudyPlan[RouteTasks]) -> RouteStudy:
    """Read the results of all jobs of the plan. Raises StudyError if a result is missing or damaged."""
    return RouteStudy(plan, read_groups(plan.of(RouteJob), lambda job: job.decisions, RouteOutcome))


def right_of(routes: Routes) -> Rate:
    """Return the share of the decisions that were right, with its interval; 0 without decisions."""
    return right_rate([each.drive for each in routes.outcomes]) or Rate(0.0, 0.0, 1.0)


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


def all_tables(study: RouteStudy) -> Iterator[Table]:
    """Yield the tables of a study of routes, in the order of its report."""
    paper = study.plan.about.task.paper
    found = [((_length(each),), verdict) for each in study.routes for verdict in verdicts(each, paper)]
    if found:
        yield targets_table(found, list(reasons_against_judging(study.plan.seeds)), headings=("route",))
    yield taught_table(study)
    yield exam_table(study)
    for each in study.routes:
        if len(study.routes) == 1 or len(each.outcomes) <= 2:
            yield robots_table(each)


def taught_table(study: RouteStudy) -> Table:
    """Return the table of the training runs, a row for each length."""

    def middle(of: Callable[[RouteOutcome], float]) -> Callable[[Routes], str]:
        return lambda each: f"{median(map(of, each.outcomes)):g}"

    return table_of(
        "What was taught",
        study.routes,
        ("route", _length),
        ("mid-level RLAs", middle(lambda each: each.mid_rlas)),
        ("quartiles", lambda each: to_text(quartiles([robot.mid_rlas for robot in each.outcomes])[::2], "g")),
        ("teaching, s", lambda each: f"{max(robot.lesson.teaching_s for robot in each.outcomes):g}"),
        ("asks", middle(lambda each: each.mid_asks)),
        ("corrections", middle(lambda each: each.mid_corrections)),
        ("missed", middle(lambda each: each.missed_junctions)),
        ("basic RLAs", middle(lambda each: each.lesson.rlas)),
        ("asks", middle(lambda each: each.lesson.asks)),
        ("corrections", middle(lambda each: each.lesson.corrections)),
        ("rescues", middle(lambda each: each.lesson.rescues)),
        note=f"Medians of {len(study.plan.seeds)} robots. Asks and corrections first of the mid level, then of the "
        "basic one. Missed: junctions that the mid level did not notice, where the teacher commanded. Robot time, "
        "without the streets, which were taught before. Taught by the scripted teacher "
        f"{study.plan.about.task.teaching.profile.name}.",
    )


def exam_table(study: RouteStudy) -> Table:
    """Return the table of the exams, a row for each length."""

    def passed(each: Routes) -> int:
        return sum(robot.drive.passed for robot in each.outcomes)

    def failed(layer: str) -> Callable[[Routes], int]:
        return lambda each: sum(wrong.layer == layer for robot in each.outcomes for wrong in robot.wrong)

    return table_of(
        "Drives without a teacher",
        study.routes,
        ("route", _length),
        ("without an error", lambda each: of_text(passed(each), len(each.outcomes))),
        ("95 %", lambda each: share_text(passed(each), len(each.outcomes))),
        (
            "decisions right",
            lambda each: f"{right_of(each).value:.2%} of {sum(r.drive.junctions for r in each.outcomes)}",
        ),
        ("95 %", lambda each: to_text(right_of(each)[1:], ".1%")),
        *((layer, failed(layer)) for layer in LAYERS),
        ("collisions", lambda each: sum(robot.drive.collisions for robot in each.outcomes)),
        ("stuck", lambda each: sum(robot.drive.ended_early for robot in each.outcomes)),
        note=f"{study.plan.about.task.exam.duration_s:g} s each. Without an error: every decision right, no "
        "collision, not stuck, not stopped by the guard. A robot that left its route is set down on it again, and "
        f"goes on; one that is stuck ends there. {_LAYERS}",
    )


def robots_table(routes: Routes) -> Table:
    """Return the table of single robots."""
    return table_of(
        f"Each robot: {_length(routes)}",
        routes.outcomes,
        ("robot", lambda each: each.seed),
        ("mid-level RLAs", lambda each: each.mid_rlas),
        ("asks", lambda each: each.mid_asks),
        ("corrections", lambda each: each.mid_corrections),
        ("right", lambda each: of_text(each.drive.right, each.drive.junctions)),
        ("collisions", lambda each: each.drive.collisions),
        ("drive, s", lambda each: f"{each.drive.duration_s:.0f}"),
        ("errors", lambda each: errors_of(each) or "none"),
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


def _length(routes: Routes) -> str:
    return f"{routes.of} decisions"


def write_routes(study: RouteStudy, pictures: Sequence[SavedFigure], command: str, path: Path) -> None:
    """Write the report of a study with its pictures as an HTML page to `path`. Raises OSError.

    `command`: typed words, without those that belong to the machine alone.
    """
    (task, basic), seeds = study.plan.about, spans(study.plan.seeds)
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
            Section("Tables", tables=list(all_tables(study))),
            Section("Drives", pictures=pictures),
            Section("How this was made"),
        ),
        reasons=list(reasons_against_judging(study.plan.seeds)),
        command=command,
        footer=f"Seeds {seeds}. {{versions}}. Source: {{source}}. One robot's lessons: `kurt2rt knowledge show` with a "
        "file of the folder `knowledge` next to this report.",
    )
