"""Tables of the transfer study."""

import math
from collections.abc import Iterator

from kurt2rt.experiments.lockstep.report import wilson_interval
from kurt2rt.experiments.study.drive import Drive
from kurt2rt.experiments.study.eligibility import reasons_against_judging
from kurt2rt.experiments.study.table import Table
from kurt2rt.experiments.study.targets_table import targets_table
from kurt2rt.experiments.transfer.plan import TransferStudy, TransferSummary
from kurt2rt.experiments.transfer.verdicts import median_of, verdicts


def all_tables(study: TransferStudy) -> Iterator[Table]:
    """Yield all tables: what was asked, the curve, the teaching, and each robot."""
    found = [((each.experiment.place,), verdict) for each in study.summaries for verdict in verdicts(each, study)]
    yield targets_table(found, list(reasons_against_judging(study.plan.seeds)), headings=("new world",))
    yield curve_table(study)
    yield teaching_table(study)
    for each in study.summaries:
        if each.studied:
            yield robots_table(each, study)


def curve_table(study: TransferStudy) -> Table:
    """Return the curve: robots that are right in the new world, by presses there, with 95 % intervals."""
    rows = []
    for each in study.summaries:
        judged, (place, how) = len(each.judged), _heading(each)
        policy = f"{sum(robot.policy.passed for robot in each.outcomes)} of {len(each.outcomes)}"
        rows.append((place, how, policy, *(_of(each.right_after(presses), judged) for presses in study.plan.after)))
        rows.append((place, f"{how}, until right", "", *(_of(each.right_by(n), judged) for n in study.plan.after)))
    return Table(
        "Robots that are right in the new world, by presses there",
        ("new world", "taught how", "policy", *(f"after {presses}" for presses in study.plan.after)),
        tuple(rows),
        words=2,
        note=f"Exams of {study.plan.task.exam.duration_s:.0f} s without a teacher, with 95 % intervals. Until right: "
        "as if teaching ended with the first exam that was passed; the best of several exams flatters. A robot that "
        "gave cause for fewer presses has all that it was taught. Policy: own drives of the teacher's policy without "
        "collision or standstill, with enough junctions right; a robot whose policy does not pass there is not judged "
        "and not counted.",
    )


def teaching_table(study: TransferStudy) -> Table:
    """Return the table of presses and seconds until right, and of the exams at home before and after."""
    rows = []
    before = sum(each.drive.passed for each in study.home)
    for each in study.summaries:
        judged = each.judged
        until = [robot.presses_until_right for robot in judged]
        rows.append(
            (
                *_heading(each),
                _median(until, study.plan.after[-1]),
                _median([robot.seconds_until_right for robot in judged], None),
                f"{median_of([float(robot.presses) for robot in each.outcomes]):g}",
                f"{median_of([float(robot.asks) for robot in each.outcomes]):g}",
                str(sum(robot.collisions for robot in each.outcomes)),
                f"{before} of {len(study.home)}" if each.experiment.variant.knows_home else "",
                f"{sum(robot.home_when_right.passed for robot in each.outcomes)} of {len(each.outcomes)}",
                f"{sum(robot.home.passed for robot in each.outcomes)} of {len(each.outcomes)}",
            )
        )
    task = study.plan.task
    presses = median_of([float(each.presses) for each in study.home])
    return Table(
        "Presses until right, and home",
        (
            *("new world", "taught how", "presses until right", "seconds until right", "presses", "asks"),
            *("collisions meanwhile", f"right in {task.teaching.world} before", "when right there", "at the end"),
        ),
        tuple(rows),
        words=2,
        note=f"Medians of {len(study.plan.seeds)} robots; collisions of all. Presses until right: the fewest of those "
        f"examined after which the exam was passed. Taught at home, in {task.teaching.world}, by the scripted teacher "
        f"{task.teaching.profile.name}, in {task.teaching.duration_s:.0f} s and {presses:g} presses (median).",
    )


def robots_table(summary: TransferSummary, study: TransferStudy) -> Table:
    """Return the table of single robots in one new world, a row for each."""
    rows = [
        (
            str(robot.seed),
            robot.world,
            f"{robot.presses}",
            f"{robot.asks}",
            drive_text(robot.policy),
            *(drive_text(point.drive) for point in robot.checkpoints),
            drive_text(before.drive),
            drive_text(robot.home_when_right),
            drive_text(robot.home),
        )
        for robot, before in zip(summary.outcomes, study.home, strict=True)
    ]
    after = (f"after {presses}" for presses in study.plan.after)
    return Table(
        f"Each robot: {summary.experiment.place}",
        ("robot", "new world", "presses", "asks", "policy", *after, "home before", "when right there", "at the end"),
        tuple(rows),
        words=2,
    )


def drive_text(drive: Drive) -> str:
    """Return one drive in few words: right, or why it is not."""
    if drive.passed:
        return "right"
    if not drive.judged:
        return "not judged"
    if drive.collisions:
        return f"{drive.collisions} collision{'' if drive.collisions == 1 else 's'}"
    if drive.alarm:
        return drive.alarm
    if drive.stuck:
        return f"stuck at {drive.duration_s:.0f} s"
    return f"{drive.right_share:.0%} of junctions right" if 0.0 < drive.right_share < 1.0 else "slow"


def _heading(summary: TransferSummary) -> tuple[str, str]:
    return summary.experiment.place, summary.experiment.variant.title


def _of(count: int, of: int) -> str:
    if not of:
        return "none judged"
    return "{} of {} ({:.0%} to {:.0%})".format(count, of, *wilson_interval(count, of))


def _median(values: list[float], most: int | None) -> str:
    """Return the median as text; `most`: the last number of presses, which an infinite median is more than."""
    if not values:
        return ""
    median = median_of(values)
    if math.isfinite(median):
        return f"{median:.0f}" if most is None else f"{median:g}"
    return "never" if most is None else f"more than {most}"
