"""Tables of training runs and exams, of one robot and of many, and the columns of drives that all studies share."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from operator import attrgetter
from typing import Any, Generic, NamedTuple

from behaviors.metrics.task_metric import JUNCTIONS, RIGHT
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.drive_row import NOT_JUDGED_BECAUSE, PLACES, DriveRow, ExamVerdict, label_of
from kurt2rt.experiments.lockstep.lesson import LessonCounts
from kurt2rt.experiments.study.intervals import collisions_in_10_min, right_rate
from kurt2rt.experiments.study.jobs import ExaminedOutcome
from kurt2rt.experiments.study.study_plan import Group, KeyT, group_by
from kurt2rt.experiments.study.table import (
    Column,
    Table,
    collisions_text,
    median,
    middle,
    of_text,
    quarters,
    rate_columns,
    share_text,
    table_of,
    to_text,
    total,
)

_SUCCESS_WORDS = {ExamVerdict.PASSED: "yes", ExamVerdict.FAILED: "no"}


class Drives(NamedTuple, Generic[KeyT]):
    """Exams that share a line of a table: those of one stage or experiment in one world, robot by robot."""

    of: KeyT
    """Stage or experiment."""
    world: str
    rows: tuple[DriveRow, ...]
    is_first: bool
    """True for the first world, whose line tells what is the same in all worlds."""

    @property
    def passed(self) -> int:
        """Number of drives that passed."""
        return sum(each.passed for each in self.rows)

    @property
    def judged(self) -> int:
        """Number of drives with a verdict; in the others the teacher's own drive got nowhere."""
        return sum(each.judged for each in self.rows)


def by_world(of: KeyT, drives: Iterable[DriveRow]) -> list[Drives[KeyT]]:
    """Return drives as lines of a table, one for each world, in order of their first drives.

    `of`: stage or experiment that the drives belong to.
    """
    groups = group_by(drives, lambda each: each.world)
    return [Drives(of, world, rows, place == 0) for place, (world, rows) in enumerate(groups)]


WORLD: Column = ("world", lambda each: label_of(each.world))
SUCCESS: tuple[Column, Column] = (
    ("success", lambda each: success_text(each.rows)),
    ("95 %", lambda each: share_text(each.passed, each.judged)),
)
STUCK = total("stuck", "ended_early")
COLLIDED: Column = ("collided", lambda each: sum(row.collisions > 0 for row in each.rows))
PROGRESS: Column = ("progress", lambda each: f"{median(row.progress for row in each.rows):.1f} {each.rows[0].unit}")
PROGRESS_QUARTILES = quarters("progress", ".1f")
UNKNOWN = middle("unknown", "share_unknown", ".1%")
RIGHT_COLUMNS: tuple[Column, Column] = (
    ("junctions right", lambda each: right_text(each.rows)),
    ("95 %", lambda each: "" if (right := right_rate(each.rows)) is None else to_text(right[1:], ".1%")),
)


def collision_columns(heading: str = "collisions in 10 min") -> tuple[Column, Column]:
    """Return the columns of the collisions in 10 min of driving, and of their interval."""
    return rate_columns(heading, lambda each: collisions_in_10_min(each.rows))


def measure_column(name: str, heading: str = "") -> Column:
    """Return the column of the median of a metric's further measure; its name is the heading without another."""

    def cell(each: Any) -> str:
        values = [row.findings[name] for row in each.rows if name in row.findings]
        return f"{median(values):.3f}" if values else ""

    return heading or name, cell


def success_text(drives: Sequence[DriveRow]) -> str:
    """Return the number of drives that passed: `18 of 20`, or `18 of 19, 1 not judged`."""
    judged = sum(each.judged for each in drives)
    left_out = f", {len(drives) - judged} not judged" if judged < len(drives) else ""
    return of_text(sum(each.passed for each in drives), judged) + left_out


def right_text(drives: Sequence[DriveRow]) -> str:
    """Return the share of the junctions that were left as asked, and how many there were; empty without any."""
    right = right_rate(drives)
    return "" if right is None else f"{right.value:.1%} of {sum(each.junctions for each in drives)}"


def lesson_table(lesson: LessonCounts, task: TaskSettings) -> Table:
    """Return the table of one training run, with the paper's numbers."""
    paper = task.paper
    rows = (
        ("teacher", lesson.teacher, paper.teacher_text),
        ("RLAs", f"{lesson.rlas}", paper.rlas_text),
        ("teaching, s of robot time", f"{lesson.teaching_s:.0f}", paper.teaching_time_text),
        ("asks", f"{lesson.asks}", ""),
        ("corrections", f"{lesson.corrections}", ""),
        ("presses", f"{lesson.presses}", ""),
        ("rescues by hand", f"{lesson.rescues}", ""),
    )
    further = (
        ("deletions", lesson.deletions),
        ("set down elsewhere", lesson.repositions),
        ("alarms of the guard", lesson.alarms),
    )
    counted = tuple((name, str(count), "") for name, count in further if count)
    title = f"Lesson: {task.name} in world {lesson.world}, seed {lesson.seed}"
    return Table(title, ("", "here", "paper"), (*rows, *counted))


def exams_as_data(exams: Sequence[DriveRow], task: TaskSettings) -> dict[str, Any]:
    """Return the numbers of exams and of the teacher's own drives, for JSON, without places."""

    def numbers(row: DriveRow | None) -> dict[str, Any] | None:
        return None if row is None else row.model_dump(exclude={"verdict", "teacher", *PLACES})

    told = [
        {
            "world": each.world,
            "succeeded": each.passed,
            "verdict": each.verdict.value,
            "learned": numbers(each),
            "teacher": numbers(each.teacher),
        }
        for each in exams
    ]
    return {"task": task.name, "exams": told}


def curriculum_as_data(lesson: LessonCounts, exams: Sequence[DriveRow], task: TaskSettings) -> dict[str, Any]:
    """Return the numbers of one lesson and its exams, for JSON. Keys tell units, as in teaching_s."""
    return {
        "lesson": lesson.model_dump(exclude={"knowledge_hash", "workload", "agreement"}),
        **exams_as_data(exams, task),
    }


def exam_tables(exams: Sequence[DriveRow], task: TaskSettings) -> Iterator[Table]:
    """Yield the table of one exam for each world, with the teacher's own drive, and of further measures."""
    unit = exams[0].unit
    yield table_of(
        f"Exams without teacher, {task.exam.duration_s:.0f} s each",
        exams,
        WORLD,
        (unit, lambda each: f"{each.progress:.2f}"),
        (f"teacher's own {unit}", lambda each: measure_text(each, ".2f")),
        ("collisions", lambda each: each.collisions),
        ("stuck", lambda each: each.early_end.removeprefix("stuck ") or "no"),
        ("unknown situations", lambda each: f"{each.share_unknown:.1%}"),
        ("success", lambda each: _SUCCESS_WORDS.get(each.verdict, each.verdict.text)),
        note="" if all(each.judged for each in exams) else f"{NOT_JUDGED_BECAUSE.capitalize()}.",
    )
    yield from _measures_tables("Measures", by_world(None, exams))


def verdict_text(exam: DriveRow) -> str:
    """Return one exam in a line, such as `2.31 of the teacher's 2.40 laps, no collision`."""
    assert exam.teacher is not None
    if not exam.judged:
        return f"{NOT_JUDGED_BECAUSE} ({exam.teacher.progress:.2f} {exam.unit})"
    why = f" ({exam.teacher.why_no_measure})" if exam.teacher.why_no_measure else ""
    way = f"{exam.progress:.2f} of the teacher's {exam.teacher.progress:.2f} {exam.unit}{why}"
    collisions = collisions_text(exam.collisions) if exam.collisions else "no collision"
    return ", ".join(filter(None, (way, collisions, exam.early_end)))


def measure_text(exam: DriveRow, form: str) -> str:
    """Return the progress of the teacher's own drive, in the format `form`, and why it is no good measure."""
    assert exam.teacher is not None
    why = exam.teacher.why_no_measure
    return f"{exam.teacher.progress:{form}}{f' ({why})' if why else ''}"


def seeds_tables(robots: Sequence[ExaminedOutcome], task: TaskSettings) -> Iterator[Table]:
    """Yield the tables of many robots: a row for each, then medians, quartiles and intervals."""
    by_place = by_world(
        None, (drive for place in zip(*(each.drives for each in robots), strict=True) for drive in place)
    )
    unit = by_place[0].rows[0].unit

    def drive(place: int) -> Callable[[ExaminedOutcome], str]:
        return lambda robot: _drive_text(robot.drives[place])

    yield table_of(
        f"{task.name}, taught by {task.teaching.profile.name}: one row per seed",
        robots,
        ("seed", lambda robot: robot.seed),
        ("RLAs", lambda robot: robot.lesson.rlas),
        *((name, attrgetter(f"lesson.{name}")) for name in ("asks", "corrections", "rescues")),
        *(
            (f"world {label_of(each.world)}: {unit} of teacher's, collisions", drive(place))
            for place, each in enumerate(by_place)
        ),
        words=0,
    )
    paper = task.paper
    rows = (
        ("RLAs", "rlas", paper.rlas_text),
        ("asks", "asks", ""),
        ("corrections", "corrections", ""),
        ("presses", "presses", ""),
        ("teaching, s of robot time", "teaching_s", paper.teaching_time_text),
    )
    taught = Group(None, tuple(robots))
    yield table_of(
        f"{len(robots)} seeds",
        rows,
        ("", lambda row: row[0]),
        ("median", lambda row: middle("", f"lesson.{row[1]}", ".0f")[1](taught)),
        ("quartiles", lambda row: quarters(f"lesson.{row[1]}", ".0f")[1](taught)),
        ("paper", lambda row: row[2]),
    )
    yield table_of(
        "Exams without teacher",
        by_place,
        WORLD,
        SUCCESS[0],
        ("95 % interval", lambda each: share_text(each.passed, each.judged) or "none"),
        COLLIDED,
        STUCK,
        middle(f"{unit}, median", "progress", ".2f"),
        middle("unknown, median", "share_unknown", ".1%"),
    )
    yield from _measures_tables("Measures, median", by_place)


def _drive_text(exam: DriveRow) -> str:
    end = f", {exam.early_end}" if exam.early_end else ""
    verdict = "" if exam.passed else f", {exam.verdict.text}"
    return f"{exam.progress:.1f} of {measure_text(exam, '.1f')}, {exam.collisions}{end}{verdict}"


def _measures_tables(title: str, worlds: Sequence[Drives[None]]) -> Iterator[Table]:
    """Yield the table of further measures, a column for each world; no table without measures."""
    names = dict.fromkeys(name for world in worlds for drive in world.rows for name in drive.findings)
    # The number of junctions is in the same cell as the number of right ones.
    shown = [name for name in names if not name.startswith(JUNCTIONS) or name.startswith(RIGHT)]

    def cell(world: Drives[None]) -> Callable[[str], str]:
        return lambda name: _measure(world.rows, name)

    if shown:
        yield table_of(title, shown, ("", str), *((label_of(world.world), cell(world)) for world in worlds))


def _measure(drives: Sequence[DriveRow], name: str) -> str:
    """Return the median, or the sum of junctions."""
    found = [each.findings for each in drives if name in each.findings]
    if not found:
        return ""
    if not name.startswith(RIGHT):
        return f"{median(each[name] for each in found):.3g}"
    passed = JUNCTIONS + name.removeprefix(RIGHT)
    return f"{sum(each[name] for each in found):.0f} of {sum(each[passed] for each in found):.0f}"
