"""Tables of training runs and exams."""

import math
from collections.abc import Sequence
from dataclasses import fields
from statistics import NormalDist
from typing import Any

from rich.console import Group, RenderableType
from rich.text import Text

from behaviors.metrics.task_metric import JUNCTIONS, RIGHT, Metrics
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import CurriculumResult, WorldResult
from kurt2rt.experiments.lockstep.exam import ExamResult
from kurt2rt.experiments.lockstep.exam_verdict import EXAM_VERDICT_TEXTS, NOT_JUDGED_BECAUSE, ExamVerdict
from kurt2rt.experiments.lockstep.seed_result import TRAILS, SeedResult
from kurt2rt.platform.text_table import TextTable

_COLOURS = {ExamVerdict.PASSED: "green", ExamVerdict.FAILED: "red", ExamVerdict.NOT_JUDGED: "yellow"}
_TWO_SIDED_95 = NormalDist().inv_cdf(0.975)
"""Standard deviations on each side of the mean that hold 95 % of a normal distribution."""
_SUCCESS_WORDS = {**EXAM_VERDICT_TEXTS, ExamVerdict.PASSED: "yes", ExamVerdict.FAILED: "no"}


def render_curriculum(result: CurriculumResult, task: TaskSettings) -> RenderableType:
    """Return the tables of one training run and its exams, with the paper's numbers."""
    lesson = result.lesson
    taught = TextTable(title=f"Lesson: {task.name} in world {lesson.world}, seed {lesson.seed}")
    taught.add_column("")
    taught.add_column("here", number=True)
    taught.add_column("paper", number=True)
    taught.add_row("teacher", lesson.teacher, task.paper.teacher_text)
    taught.add_row("RLAs", str(len(lesson.rlas)), task.paper.rlas_text)
    taught.add_row("teaching, s of robot time", f"{lesson.teaching_s:.0f}", task.paper.teaching_time_text)
    taught.add_row("asks", str(lesson.asks), "")
    taught.add_row("corrections", str(lesson.corrections), "")
    taught.add_row("presses", str(lesson.presses), "")
    taught.add_row("rescues by hand", str(lesson.rescues), "")
    if lesson.deletions:
        taught.add_row("deletions", str(lesson.deletions), "")
    if lesson.repositions:
        taught.add_row("set down elsewhere", str(lesson.repositions), "")
    if lesson.alarms:
        taught.add_row("alarms of the guard", str(lesson.alarms), "")
    return Group(taught, render_exams(result.exams, task)) if result.exams else taught


_JSON_NAMES = {"distance_travelled_m": "way_m"}
"""Keys that differ from the names of the fields."""


def curriculum_as_data(result: SeedResult, task: TaskSettings) -> dict[str, Any]:
    """Return the numbers of one lesson and its exams, for JSON. Keys tell units, as in teaching_s."""
    taught = result.lesson.model_dump(exclude={"knowledge_hash", "collisions"})
    return {"lesson": taught, **exams_as_data(result.exams, task)}


def exams_as_data(exams: Sequence[WorldResult], task: TaskSettings) -> dict[str, Any]:
    """Return the numbers of exams and of the teacher's own drives, for JSON, without trails."""
    return {
        "task": task.name,
        "exams": [
            {
                "world": each.learned.world,
                "succeeded": each.succeeded,
                "verdict": each.verdict.value,
                "learned": _exam_as_data(each.learned),
                "teacher": _exam_as_data(each.teacher),
            }
            for each in exams
        ],
    }


def _exam_as_data(exam: ExamResult) -> dict[str, Any]:
    names = {field.name: _JSON_NAMES.get(field.name, field.name) for field in fields(exam) if field.name not in TRAILS}
    return {key: getattr(exam, name) for name, key in names.items()}


def render_exams(exams: Sequence[WorldResult], task: TaskSettings) -> RenderableType:
    """Return the table of one exam for each world, with the teacher's own drive."""
    driven = TextTable(title=f"Exams without teacher, {task.exam.duration_s:.0f} s each")
    unit = exams[0].learned.unit
    headings = ("world", unit, f"teacher's own {unit}", "collisions", "stuck", "unknown situations", "success")
    for heading in headings:
        driven.add_column(heading, number=heading != "world")
    for each in exams:
        exam = each.learned
        driven.add_row(
            label_of(exam.world),
            f"{exam.progress:.2f}",
            f"{each.teacher.progress:.2f}{_not_well(each.teacher)}",
            str(exam.collisions),
            _early_end(exam, "after") or "no",
            f"{exam.share_unknown:.1%}",
            Text(_SUCCESS_WORDS[each.verdict], _COLOURS[each.verdict]),
        )
    measured = _render_measures("Measures", [each.learned.world for each in exams], [[each.learned] for each in exams])
    note = [NOT_JUDGED_BECAUSE.capitalize() + "."] if any(not_judged(each) for each in exams) else []
    return Group(driven, *note, *measured)


def not_judged(result: WorldResult) -> bool:
    """Return whether the exam has no verdict."""
    return result.verdict is ExamVerdict.NOT_JUDGED


def verdict_of(result: WorldResult) -> str:
    """Return one exam in a line, such as `2.31 of the teacher's 2.40 laps, no collision`."""
    exam = result.learned
    collisions = {0: "no collision", 1: "1 collision"}.get(exam.collisions, f"{exam.collisions} collisions")
    of = f"of the teacher's {result.teacher.progress:.2f} {exam.unit}{_not_well(result.teacher)}"
    if not_judged(result):
        return f"{NOT_JUDGED_BECAUSE} ({result.teacher.progress:.2f} {exam.unit})"
    parts = [f"{exam.progress:.2f} {of}", collisions, _early_end(exam, "stuck after")]
    return ", ".join(part for part in parts if part)


def _render_measures(title: str, worlds: Sequence[str], exams: Sequence[Sequence[ExamResult]]) -> list[TextTable]:
    """Return the table of further measures, a column for each world; no table without measures."""
    names = dict.fromkeys(name for each in exams for exam in each for name in exam.findings)
    # The number of junctions is in the same cell as the number of right ones.
    shown = [name for name in names if not name.startswith(JUNCTIONS) or name.startswith(RIGHT)]
    table = TextTable(title=title)
    table.add_column("")
    for world in worlds:
        table.add_column(label_of(world), number=True)
    for name in shown:
        table.add_row(
            name, *(_measure([exam.findings for exam in each if name in exam.findings], name) for each in exams)
        )
    return [table] if shown else []


def _measure(findings: Sequence[Metrics], name: str) -> str:
    """Return the median, or the sum of junctions."""
    if not findings:
        return ""
    values = [found[name] for found in findings]
    if not name.startswith(RIGHT):
        return f"{quartiles(values)[1]:.3g}"
    passed = JUNCTIONS + name.removeprefix(RIGHT)
    return f"{sum(values):.0f} of {sum(found[passed] for found in findings):.0f}"


def _early_end(exam: ExamResult, stuck: str) -> str:
    """Why and when an exam ended before its time; empty when it did not. `stuck`: what is said where no alarm was."""
    if not exam.stuck and not exam.alarm:
        return ""
    return f"{exam.alarm or stuck}{' after' if exam.alarm else ''} {exam.duration_s:.0f} s"


def _not_well(teacher: ExamResult) -> str:
    """Why the teacher's own drive is no good measure; empty when it is."""
    return " (got nowhere)" if teacher.got_nowhere else " (failed)" if teacher.failed else ""


def label_of(world: str) -> str:
    """Return the label of a world: a capital letter for shipped ones, else the name."""
    return world.upper() if len(world) == 1 else world


def wilson_interval(successes: int, trials: int) -> tuple[float, float]:
    """Return the 95 % interval of a share (Wilson's score interval), as (low, high), each 0 to 1.

    It holds for few trials and shares near 0 and 1, too.

    Computed here: scipy.stats has it, but takes 0.6 s to import.
    """
    share, per_trial = successes / trials, _TWO_SIDED_95**2 / trials
    centre = share + per_trial / 2
    half_width = _TWO_SIDED_95 * math.sqrt(share * (1.0 - share) / trials + per_trial / (4 * trials))
    low, high = (centre - half_width) / (1.0 + per_trial), (centre + half_width) / (1.0 + per_trial)
    return low if successes else 0.0, high if successes < trials else 1.0


def quartiles(values: Sequence[float]) -> tuple[float, float, float]:
    """Return lower quartile, median and upper quartile by linear interpolation, in the unit of the values."""
    ordered = sorted(values)

    def at(share: float) -> float:
        place = share * (len(ordered) - 1)
        low = math.floor(place)
        high = min(low + 1, len(ordered) - 1)
        return ordered[low] + (place - low) * (ordered[high] - ordered[low])

    return at(0.25), at(0.5), at(0.75)


def render_seeds(results: Sequence[SeedResult], task: TaskSettings) -> RenderableType:
    """Return the tables of many seeds: a row for each, then medians, quartiles and intervals."""
    worlds = [each.learned.world for each in results[0].exams]
    unit = results[0].exams[0].learned.unit
    seeds = TextTable(title=f"{task.name}, taught by {task.teaching.profile.name}: one row per seed")
    for heading in ("seed", "RLAs", "asks", "corrections", "rescues"):
        seeds.add_column(heading, number=True)
    for world in worlds:
        seeds.add_column(f"world {label_of(world)}: {unit} of teacher's, collisions", number=True)
    for result in results:
        lesson = result.lesson
        cells = []
        for each in result.exams:
            exam = each.learned
            early = _early_end(exam, "stuck at")
            end = f", {early}" if early else ""
            colour = _COLOURS[each.verdict]
            of_teacher = f"{each.teacher.progress:.1f}{_not_well(each.teacher)}"
            unjudged = f", {EXAM_VERDICT_TEXTS[each.verdict]}" if not_judged(each) else ""
            cells.append(Text(f"{exam.progress:.1f} of {of_teacher}, {exam.collisions}{end}{unjudged}", colour))
        numbers = (lesson.seed, lesson.rlas, lesson.asks, lesson.corrections, lesson.rescues)
        seeds.add_row(*map(str, numbers), *cells)

    by_world = [[result.exams[place].learned for result in results] for place in range(len(worlds))]
    measures = _render_measures("Measures, median", worlds, by_world)
    return Group(seeds, _render_medians(results, task), _render_success(results), *measures)


def _render_medians(results: Sequence[SeedResult], task: TaskSettings) -> TextTable:
    summary = TextTable(title=f"{len(results)} seeds")
    for heading in ("", "median", "quartiles", "paper"):
        summary.add_column(heading, number=bool(heading))
    counted = (
        ("RLAs", [result.lesson.rlas for result in results], task.paper.rlas_text),
        ("asks", [result.lesson.asks for result in results], ""),
        ("corrections", [result.lesson.corrections for result in results], ""),
        ("presses", [result.lesson.presses for result in results], ""),
        ("teaching, s of robot time", [result.lesson.teaching_s for result in results], task.paper.teaching_time_text),
    )
    for name, values, paper in counted:
        low, median, high = quartiles(values)
        summary.add_row(name, f"{median:.0f}", f"{low:.0f} to {high:.0f}", paper)
    return summary


def _render_success(results: Sequence[SeedResult]) -> TextTable:
    worlds = [each.learned.world for each in results[0].exams]
    unit = results[0].exams[0].learned.unit
    success = TextTable(title="Exams without teacher")
    for heading in ("world", "success", "95 % interval", "collided", "stuck", f"{unit}, median", "unknown, median"):
        success.add_column(heading, number=heading != "world")
    for place, world in enumerate(worlds):
        exams = [result.exams[place] for result in results]
        passed = sum(each.succeeded for each in exams)
        judged = len(exams) - sum(map(not_judged, exams))
        unjudged = f", {len(exams) - judged} not judged" if judged < len(exams) else ""
        success.add_row(
            label_of(world),
            f"{passed} of {judged}{unjudged}",
            "{:.0%} to {:.0%}".format(*wilson_interval(passed, judged)) if judged else "none",
            str(sum(each.learned.collisions > 0 for each in exams)),
            str(sum(each.learned.stuck or bool(each.learned.alarm) for each in exams)),
            f"{quartiles([each.learned.progress for each in exams])[1]:.2f}",
            f"{quartiles([each.learned.share_unknown for each in exams])[1]:.1%}",
        )
    return success
