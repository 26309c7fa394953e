"""Tables of training runs and exams, of one robot and of many seeds."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from behaviors.metrics.task_metric import JUNCTIONS, RIGHT
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.drive_row import NOT_JUDGED_BECAUSE, PLACES, DriveRow, ExamVerdict, label_of
from kurt2rt.experiments.lockstep.lesson import LessonCounts
from kurt2rt.experiments.study.intervals import quartiles
from kurt2rt.experiments.study.table import Table, median, of_text, share_text, table_of, to_text

Robot = tuple[LessonCounts, Sequence[DriveRow]]
"""Training run of one robot, and its exams, one in each world."""
_SUCCESS_WORDS = {ExamVerdict.PASSED: "yes", ExamVerdict.FAILED: "no"}


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
    told = []
    for each in exams:
        learned, teacher = (
            None if row is None else row.model_dump(exclude={"verdict", "teacher", *PLACES})
            for row in (each, each.teacher)
        )
        told.append(
            {
                "world": each.world,
                "succeeded": each.passed,
                "verdict": each.verdict.value,
                "learned": learned,
                "teacher": teacher,
            }
        )
    return {"task": task.name, "exams": told}


def curriculum_as_data(lesson: LessonCounts, exams: Sequence[DriveRow], task: TaskSettings) -> dict[str, Any]:
    """Return the numbers of one lesson and its exams, for JSON. Keys tell units, as in teaching_s."""
    return {"lesson": lesson.model_dump(exclude={"knowledge_hash", "collisions"}), **exams_as_data(exams, task)}


def exam_tables(exams: Sequence[DriveRow], task: TaskSettings) -> Iterator[Table]:
    """Yield the table of one exam for each world, with the teacher's own drive, and of further measures."""
    unit = exams[0].unit
    yield table_of(
        f"Exams without teacher, {task.exam.duration_s:.0f} s each",
        exams,
        ("world", lambda each: label_of(each.world)),
        (unit, lambda each: f"{each.progress:.2f}"),
        (f"teacher's own {unit}", lambda each: measure_text(each, ".2f")),
        ("collisions", lambda each: each.collisions),
        ("stuck", lambda each: each.early_end.removeprefix("stuck ") or "no"),
        ("unknown situations", lambda each: f"{each.share_unknown:.1%}"),
        ("success", lambda each: _SUCCESS_WORDS.get(each.verdict, each.verdict.text)),
        note="" if all(each.judged for each in exams) else f"{NOT_JUDGED_BECAUSE.capitalize()}.",
    )
    yield from _measures_tables("Measures", [(each.world, [each]) for each in exams])


def verdict_text(exam: DriveRow) -> str:
    """Return one exam in a line, such as `2.31 of the teacher's 2.40 laps, no collision`."""
    assert exam.teacher is not None
    if not exam.judged:
        return f"{NOT_JUDGED_BECAUSE} ({exam.teacher.progress:.2f} {exam.unit})"
    collisions = {0: "no collision", 1: "1 collision"}.get(exam.collisions, f"{exam.collisions} collisions")
    why = f" ({exam.teacher.why_no_measure})" if exam.teacher.why_no_measure else ""
    way = f"{exam.progress:.2f} of the teacher's {exam.teacher.progress:.2f} {exam.unit}{why}"
    return ", ".join(filter(None, (way, collisions, exam.early_end)))


def measure_text(exam: DriveRow, form: str) -> str:
    """Return the progress of the teacher's own drive, in the format `form`, and why it is no good measure."""
    assert exam.teacher is not None
    why = exam.teacher.why_no_measure
    return f"{exam.teacher.progress:{form}}{f' ({why})' if why else ''}"


def seeds_tables(robots: Sequence[Robot], task: TaskSettings) -> Iterator[Table]:
    """Yield the tables of many robots: a row for each, then medians, quartiles and intervals."""
    by_world = [(drives[0].world, drives) for drives in zip(*(exams for _, exams in robots), strict=True)]
    unit = by_world[0][1][0].unit

    def counted(name: str) -> Callable[[Robot], object]:
        return lambda robot: getattr(robot[0], name)

    def cell(place: int) -> Callable[[Robot], str]:
        return lambda robot: _drive_text(robot[1][place])

    yield table_of(
        f"{task.name}, taught by {task.teaching.profile.name}: one row per seed",
        robots,
        ("seed", counted("seed")),
        ("RLAs", counted("rlas")),
        *((name, counted(name)) for name in ("asks", "corrections", "rescues")),
        *(
            (f"world {label_of(world)}: {unit} of teacher's, collisions", cell(place))
            for place, (world, _) in enumerate(by_world)
        ),
        words=0,
    )
    yield _medians_table([lesson for lesson, _ in robots], task)
    yield table_of(
        "Exams without teacher",
        by_world,
        ("world", lambda each: label_of(each[0])),
        ("success", lambda each: success_text(each[1])),
        (
            "95 % interval",
            lambda each: share_text(sum(d.passed for d in each[1]), sum(d.judged for d in each[1])) or "none",
        ),
        ("collided", lambda each: sum(drive.collisions > 0 for drive in each[1])),
        ("stuck", lambda each: sum(drive.ended_early for drive in each[1])),
        (f"{unit}, median", lambda each: f"{median(drive.progress for drive in each[1]):.2f}"),
        ("unknown, median", lambda each: f"{median(drive.share_unknown for drive in each[1]):.1%}"),
    )
    yield from _measures_tables("Measures, median", by_world)


def _drive_text(exam: DriveRow) -> str:
    end = f", {exam.early_end}" if exam.early_end else ""
    verdict = "" if exam.passed else f", {exam.verdict.text}"
    return f"{exam.progress:.1f} of {measure_text(exam, '.1f')}, {exam.collisions}{end}{verdict}"


def success_text(drives: Sequence[DriveRow]) -> str:
    """Return the number of drives that passed: `18 of 20`, or `18 of 19, 1 not judged`."""
    judged = sum(each.judged for each in drives)
    left_out = f", {len(drives) - judged} not judged" if judged < len(drives) else ""
    return of_text(sum(each.passed for each in drives), judged) + left_out


def _medians_table(lessons: Sequence[LessonCounts], task: TaskSettings) -> Table:
    def of(name: str) -> tuple[float, float, float]:
        return quartiles([getattr(each, name) for each in lessons])

    rows = (
        ("RLAs", "rlas", task.paper.rlas_text),
        ("asks", "asks", ""),
        ("corrections", "corrections", ""),
        ("presses", "presses", ""),
        ("teaching, s of robot time", "teaching_s", task.paper.teaching_time_text),
    )
    return table_of(
        f"{len(lessons)} seeds",
        rows,
        ("", lambda row: row[0]),
        ("median", lambda row: f"{of(row[1])[1]:.0f}"),
        ("quartiles", lambda row: to_text(of(row[1])[::2], ".0f")),
        ("paper", lambda row: row[2]),
    )


def _measures_tables(title: str, by_world: Sequence[tuple[str, Sequence[DriveRow]]]) -> Iterator[Table]:
    """Yield the table of further measures, a column for each world; no table without measures."""
    names = dict.fromkeys(name for _, drives in by_world for drive in drives for name in drive.findings)
    # The number of junctions is in the same cell as the number of right ones.
    shown = [name for name in names if not name.startswith(JUNCTIONS) or name.startswith(RIGHT)]

    def cell(drives: Sequence[DriveRow]) -> Callable[[str], str]:
        return lambda name: _measure(drives, name)

    if shown:
        columns = ((label_of(world), cell(drives)) for world, drives in by_world)
        yield table_of(title, shown, ("", lambda name: name), *columns)


def _measure(drives: Sequence[DriveRow], name: str) -> str:
    """Return the median, or the sum of junctions."""
    found = [each.findings for each in drives if name in each.findings]
    if not found:
        return ""
    if not name.startswith(RIGHT):
        return f"{median(each[name] for each in found):.3g}"
    passed = JUNCTIONS + name.removeprefix(RIGHT)
    return f"{sum(each[name] for each in found):.0f} of {sum(each[passed] for each in found):.0f}"
