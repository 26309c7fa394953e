"""Tables and figure of the transfer study."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.study.figures import save
from kurt2rt.experiments.study.intervals import wilson_interval
from kurt2rt.experiments.study.study_plan import Group, StudyPlan, read_groups
from kurt2rt.experiments.study.table import Table, collisions_text, of_text, table_of
from kurt2rt.experiments.study.targets import Verdict, needed_of, reasons_against_judging, targets_table
from kurt2rt.experiments.transfer.study import (
    HomeJob,
    HomeOutcome,
    Transfer,
    TransferJob,
    TransferOutcome,
)

RIGHT_SHARE = 18 / 20
"""Share of the robots that are to be right in the new world."""
MOST_PRESSES = 10
"""Presses until right that half of the robots may need at most."""
_COLOUR = "#1f6fb2"
There = Group[str, TransferOutcome]
"""Robots in one kind of new world."""


@dataclass(frozen=True, slots=True)
class TransferStudy:
    """Plan and outcomes of the study."""

    plan: StudyPlan[Transfer]
    home: tuple[HomeOutcome, ...]
    """One per robot, in the order of the seeds."""
    there: tuple[There, ...]


def read_study(plan: StudyPlan[Transfer]) -> TransferStudy:
    """Read the results of all jobs of the plan. Raises StudyError if a result is missing or damaged."""
    return TransferStudy(
        plan,
        tuple(job.results.read(job, HomeOutcome) for job in plan.of(HomeJob)),
        read_groups(plan.of(TransferJob), lambda job: job.place, TransferOutcome),
    )


def all_tables(study: TransferStudy) -> Iterator[Table]:
    """Yield all tables: what was asked, the curve, the teaching, and each robot."""
    found = [((each.of,), verdict) for each in study.there for verdict in verdicts(each, study)]
    yield targets_table(found, list(reasons_against_judging(study.plan.seeds)), headings=("new world",))
    yield curve_table(study)
    yield teaching_table(study)
    for each in study.there:
        yield robots_table(each, study)


def judged_of(group: There) -> tuple[TransferOutcome, ...]:
    """Return the outcomes whose exams in the new world have verdicts."""
    return tuple(each for each in group.outcomes if each.judged)


def right_after(group: There, presses: int) -> int:
    """Return the number of robots that pass the exam in the new world after so many presses."""
    return sum(point.passed for each in judged_of(group) for point in each.checkpoints if point.presses == presses)


def right_by(group: There, presses: int) -> int:
    """Return the number of robots that pass an exam in the new world after so many presses or fewer."""
    return sum(each.presses_until_right <= presses for each in judged_of(group))


def verdicts(group: There, study: TransferStudy) -> Iterator[Verdict]:
    """Yield the verdicts on robots with the knowledge of home; none if no exam has a verdict."""
    judged, robots = judged_of(group), len(group.outcomes)
    if not judged:
        return
    presses = study.plan.about.after[-1]
    right, needed = right_by(group, presses), needed_of(RIGHT_SHARE, len(judged))
    yield Verdict(
        f"right there after at most {presses} presses",
        f"at least {of_text(needed, len(judged))}",
        of_text(right, len(judged)),
        right >= needed,
    )
    until = median_of([each.presses_until_right for each in judged])
    shown = f"{until:g}" if math.isfinite(until) else f"more than {presses}"
    yield Verdict("presses until right, median", f"at most {MOST_PRESSES}", shown, until <= MOST_PRESSES)
    after = sum(each.home_when_right.passed for each in group.outcomes)
    before = sum(each.drive.passed for each in study.home)
    came = f"{of_text(after, robots)} (before: {before})"
    yield Verdict("right at home as soon as right there", of_text(robots, robots), came, after == robots)


def curve_table(study: TransferStudy) -> Table:
    """Return the curve: robots that are right in the new world, by presses there, with 95 % intervals."""
    after = study.plan.about.after
    rows = []
    for each in study.there:
        judged, place = len(judged_of(each)), each.of
        policy = of_text(sum(robot.policy.passed for robot in each.outcomes), len(each.outcomes))
        shares = [of_text(right_after(each, n), judged, interval=True) for n in after]
        until_right = [of_text(right_by(each, n), judged, interval=True) for n in after]
        rows.append((place, "taught on", policy, *shares))
        rows.append((place, "until right", "", *until_right))
    return Table(
        "Robots that are right in the new world, by presses there",
        ("new world", "taught how", "policy", *(f"after {presses}" for presses in after)),
        tuple(rows),
        words=2,
        note=f"Exams of {study.plan.about.task.exam.duration_s:.0f} s without a teacher, with 95 % intervals. Until "
        "right: as if teaching ended with the first exam that was passed; the best of several exams flatters. A robot "
        "that needed fewer presses has all that it was taught. Policy: own drives of the teacher's policy without "
        "collision or standstill, with enough junctions right. A robot whose policy fails there is not judged and not "
        "counted.",
    )


def teaching_table(study: TransferStudy) -> Table:
    """Return the table of presses and seconds until right, and of the exams at home before and after."""
    (task, after), before = study.plan.about, sum(each.drive.passed for each in study.home)

    def until(group: There, name: str, form: str, never: str) -> str:
        values = [getattr(robot, name) for robot in judged_of(group)]
        return "" if not values else f"{median_of(values):{form}}" if math.isfinite(median_of(values)) else never

    def median_text(robots: Sequence[HomeOutcome | TransferOutcome], name: str) -> str:
        return f"{median_of([float(getattr(robot.lesson, name)) for robot in robots]):g}"

    return table_of(
        "Presses until right, and home",
        study.there,
        ("new world", lambda each: each.of),
        ("presses until right", lambda each: until(each, "presses_until_right", "g", f"more than {after[-1]}")),
        ("seconds until right", lambda each: until(each, "seconds_until_right", ".0f", "never")),
        ("presses", lambda each: median_text(each.outcomes, "presses")),
        ("asks", lambda each: median_text(each.outcomes, "asks")),
        ("collisions meanwhile", lambda each: sum(robot.lesson.collisions for robot in each.outcomes)),
        (
            f"right in {task.teaching.world} before",
            lambda _: of_text(before, len(study.home)),
        ),
        (
            "when right there",
            lambda each: of_text(sum(robot.home_when_right.passed for robot in each.outcomes), len(each.outcomes)),
        ),
        ("at the end", lambda each: of_text(sum(robot.home.passed for robot in each.outcomes), len(each.outcomes))),
        note=f"Medians of {len(study.plan.seeds)} robots; collisions of all. Presses until right: the fewest of those "
        f"examined after which the exam was passed. Taught at home, in {task.teaching.world}, by the scripted teacher "
        f"{task.teaching.profile.name}, in {task.teaching.duration_s:.0f} s and {median_text(study.home, 'presses')} "
        "presses (median).",
    )


def robots_table(group: There, study: TransferStudy) -> Table:
    """Return the table of single robots in one new world, a row for each."""
    rows = [
        (
            str(robot.seed),
            robot.lesson.world,
            str(robot.lesson.presses),
            str(robot.lesson.asks),
            drive_text(robot.policy),
            *(drive_text(point.drives[0]) for point in robot.checkpoints),
            *map(drive_text, (before.drive, robot.home_when_right, robot.home)),
        )
        for robot, before in zip(group.outcomes, study.home, strict=True)
    ]
    after = (f"after {presses}" for presses in study.plan.about.after)
    return Table(
        f"Each robot: {group.of}",
        ("robot", "new world", "presses", "asks", "policy", *after, "home before", "when right there", "at the end"),
        tuple(rows),
        words=2,
    )


def drive_text(drive: DriveRow) -> str:
    """Return one drive in few words: right, or why it is not."""
    if drive.passed:
        return "right"
    if not drive.judged:
        return "not judged"
    if drive.collisions:
        return collisions_text(drive.collisions)
    if drive.alarm:
        return drive.alarm
    if drive.stuck:
        return f"stuck at {drive.duration_s:.0f} s"
    return f"{drive.right_share:.0%} of junctions right" if 0.0 < drive.right_share < 1.0 else "slow"


def median_of(values: list[float]) -> float:
    """Return the median of counts or times in s, which may be infinite; of two middle values their mean."""
    ordered = sorted(values)
    low, high = ordered[(len(ordered) - 1) // 2], ordered[len(ordered) // 2]
    return low if low == high else (low + high) / 2


def draw_curves(study: TransferStudy, path: Path) -> None:
    """Draw the curves, a panel for each new world, as a PNG to `path`. Raises OSError."""
    figure = Figure(figsize=(5.4 * len(study.there), 5.0), layout="constrained")
    panels = figure.subplots(1, len(study.there), squeeze=False, sharey=True).flatten().tolist()
    for axes, group in zip(panels, study.there, strict=True):
        if judged_of(group):
            _draw(axes, study.plan.about.after, group)
        axes.set_title(f"new world: {Path(group.of).stem}", fontsize="medium")
        axes.set_xlabel("presses in the new world (dotted: taught until right)")
        axes.set_ylim(-0.03, 1.03)
        axes.grid(alpha=0.3)
    panels[0].set_ylabel("share of robots that are right there")
    save(figure, path)


def _draw(axes: Axes, after: tuple[int, ...], group: There) -> None:
    judged = len(judged_of(group))
    axes.plot(after, [right_by(group, n) / judged for n in after], color=_COLOUR, linestyle=":", linewidth=1.2)
    counts = [right_after(group, presses) for presses in after]
    low, high = zip(*(wilson_interval(count, judged) for count in counts), strict=True)
    axes.plot(after, [count / judged for count in counts], color=_COLOUR, marker="o", label=f"n = {judged}")
    axes.fill_between(after, low, high, color=_COLOUR, alpha=0.15)
    axes.legend(fontsize="small", loc="upper center", bbox_to_anchor=(0.5, -0.14), frameon=False)
