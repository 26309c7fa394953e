"""The tables of the results."""

from collections.abc import Iterator, Sequence

from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.report import wilson_interval
from kurt2rt.experiments.route.outcome import RouteOutcome
from kurt2rt.experiments.route.summary import RouteStudy, RouteSummary
from kurt2rt.experiments.route.verdicts import verdicts
from kurt2rt.experiments.study.eligibility import reasons_against_judging
from kurt2rt.experiments.study.table import Table
from kurt2rt.experiments.study.targets_table import targets_table

_LAYERS = (
    "Which layer failed: symbols: what the robot had noticed of junctions was not what it had done there; mid: it had "
    "noticed everything, and wanted something else or asked; basic: it was told what is right, and did not do it."
)


def all_tables(study: RouteStudy) -> Iterator[Table]:
    """Yield all tables."""
    found = [
        ((_heading(each)[1],), verdict) for each in study.summaries for verdict in verdicts(each, study.plan.task.paper)
    ]
    if found:
        yield targets_table(found, list(reasons_against_judging(study.plan.seeds)), headings=("route",))
    yield taught_table(study.summaries)
    yield exam_table(study.summaries)
    for summary in study.summaries:
        if len(study.summaries) == 1 or summary.robots <= 2:
            yield robots_table(summary)


def taught_table(summaries: Sequence[RouteSummary]) -> Table:
    """Return the table of the training runs, a row for each length and variant."""
    rows = []
    for each in summaries:
        low, median, high = each.quartiles("mid_rlas")
        numbers = ("mid_asks", "mid_corrections", "missed_junctions", "basic_rlas", "asks", "corrections", "rescues")
        rows.append(
            (
                *_heading(each),
                f"{median:g}",
                f"{low:g} to {high:g}",
                f"{max(outcome.teaching_s for outcome in each.outcomes):g}",
                *(f"{each.quartiles(name)[1]:g}" for name in numbers),
            )
        )
    return Table(
        "What was taught",
        (
            *("taught how", "route", "mid-level RLAs", "quartiles", "teaching, s", "asks", "corrections", "missed"),
            *("basic RLAs", "asks", "corrections", "rescues"),
        ),
        tuple(rows),
        words=2,
        note=f"Medians of {summaries[0].robots} robots. Asks and corrections first of the mid level, then of the basic "
        "one. Missed: junctions that the mid level did not notice, where the teacher commanded. Robot time, without "
        f"the streets, which were taught before. {_taught_by(summaries)}",
    )


def _taught_by(summaries: Sequence[RouteSummary]) -> str:
    names = sorted({job.task.teaching.profile.name for each in summaries for job in each.experiment.jobs})
    return f"Taught by the scripted teacher {' or '.join(names)}."


def exam_table(summaries: Sequence[RouteSummary]) -> Table:
    """Return the table of the exams, a row for each length and variant."""
    rows = []
    for each in summaries:
        low, high = wilson_interval(each.without_error, each.robots)
        right = each.right
        rows.append(
            (
                *_heading(each),
                f"{each.without_error} of {each.robots}",
                f"{low:.0%} to {high:.0%}",
                f"{right.value:.2%} of {each.junctions}",
                f"{right.low:.1%} to {right.high:.1%}",
                *(str(number) for number in each.failures.values()),
                str(sum(outcome.drive.collisions for outcome in each.outcomes)),
                str(sum(outcome.drive.stuck or bool(outcome.drive.alarm) for outcome in each.outcomes)),
            )
        )
    times_s = sorted({job.task.exam.duration_s for each in summaries for job in each.experiment.jobs})
    return Table(
        "Drives without a teacher",
        (
            *("taught how", "route", "without an error", "95 %", "decisions right", "95 %"),
            *("symbols", "mid", "basic", "collisions", "stuck"),
        ),
        tuple(rows),
        words=2,
        note=f"{' or '.join(f'{time_s:g}' for time_s in times_s)} s each. Without an error: every decision right, no "
        "collision, not stuck, not stopped by the guard. A robot that left its route is set down on it again, and "
        f"goes on; one that is stuck ends there. {_LAYERS}",
    )


def robots_table(summary: RouteSummary) -> Table:
    """Return the table of single robots."""
    rows = tuple((str(each.seed), *_of_robot(each)) for each in summary.outcomes)
    return Table(
        f"Each robot: {', '.join(_heading(summary))}",
        ("robot", "mid-level RLAs", "asks", "corrections", "right", "collisions", "drive, s", "errors"),
        rows,
        words=1,
    )


def robot_table(outcome: RouteOutcome, task: TaskSettings) -> Table:
    """Return the table of one robot, with the paper's numbers."""
    drive, paper = outcome.drive, task.paper
    rows = (
        ("teacher", task.teaching.profile.name, "a person"),
        ("mid-level RLAs", str(outcome.mid_rlas), str(paper.rlas)),
        ("teaching, s of robot time", f"{outcome.teaching_s:.0f}", paper.teaching_time_text),
        ("questions of the mid level", str(outcome.mid_asks), ""),
        ("corrections of the mid level", str(outcome.mid_corrections), ""),
        ("junctions that it did not notice", str(outcome.missed_junctions), ""),
        ("RLAs of the basic level", str(outcome.basic_rlas), ""),
        ("its questions", str(outcome.asks), ""),
        ("its corrections", str(outcome.corrections), ""),
        ("rescues by hand", str(outcome.rescues), ""),
        (f"drive without a teacher, s of {task.exam.duration_s:.0f}", f"{drive.duration_s:.0f}", ""),
        ("decisions right", f"{drive.right} of {drive.junctions}", ""),
        ("collisions", str(drive.collisions), ""),
        ("errors", errors_of(outcome) or "none", ""),
    )
    title = f"Route of {len(outcome.route)} decisions: robot {outcome.seed}"
    return Table(title, ("", "here", "paper"), rows, words=1)


def errors_of(outcome: RouteOutcome) -> str:
    """Return the errors of a drive with their times."""
    drive = outcome.drive
    said = [f"{each.layer} at {each.at_s:.0f} s (decision {each.leg + 1})" for each in drive.wrong]
    said += [f"{drive.collisions} collision{'' if drive.collisions == 1 else 's'}"] if drive.collisions else []
    said += ["stuck"] if drive.stuck else []
    said += [drive.alarm] if drive.alarm else []
    return ", ".join(said)


def _of_robot(outcome: RouteOutcome) -> tuple[str, ...]:
    drive = outcome.drive
    return (
        str(outcome.mid_rlas),
        str(outcome.mid_asks),
        str(outcome.mid_corrections),
        f"{drive.right} of {drive.junctions}",
        str(drive.collisions),
        f"{drive.duration_s:.0f}",
        errors_of(outcome) or "none",
    )


def _heading(summary: RouteSummary) -> tuple[str, str]:
    return summary.experiment.variant.title, f"{summary.experiment.decisions} decisions"
