"""Comparison of scripted teachers: the same seeds, taught in other ways."""

from collections.abc import Mapping, Sequence

from kurt2rt.core.task_settings import TaskSettings, taught_by
from kurt2rt.core.teacher_settings import QUICK_TEACHER, ShowSettings, TeacherProfile, load_teacher
from kurt2rt.experiments.lockstep.report import label_of, not_judged, quartiles
from kurt2rt.experiments.lockstep.seed_result import SeedResult
from kurt2rt.platform.text_table import TextTable

_MINUTE_S = 60.0
_SLOW = 0.6
"""Lesson speed of the control of a teacher whose lessons are at full speed."""


_SHOWS = ShowSettings(times=4, seconds=8.0, speed=0.6)
"""Demonstrations of a teacher who shows first."""


def compared_tasks(task: TaskSettings) -> dict[str, TaskSettings]:
    """Return the task with its own teacher and its controls, by label.

    The controls are the other ways to correct, the teacher's own way after demonstrations and with lessons at the other
    speed, the superhuman teacher, and the one that answers only. Raises hal.settings.SettingsError.
    """
    own = task.teaching.profile
    speed = own.lesson_speeds.get(task.name, task.teaching.lesson_speed)
    other_speed = _SLOW if speed == 1.0 else 1.0
    ways: dict[str, TeacherProfile] = {
        own.corrects_by: own,
        **{way: own.model_copy(update={"corrects_by": way}) for way in ("press", "hold", "rewind")},
        f"{own.corrects_by}, shows first": own.model_copy(update={"shows": _SHOWS}),
        f"{own.corrects_by}, lesson at {other_speed:.0%} of the speed": own.model_copy(
            update={"lesson_speeds": {**own.lesson_speeds, task.name: other_speed}}
        ),
    }
    profiles = {f"{own.name}, {way}": each for way, each in ways.items()}
    for each in (QUICK_TEACHER, load_teacher("answers_only")):
        profiles[f"{each.name}, {each.corrects_by}"] = each
    return {label: taught_by(task, each) for label, each in profiles.items()}


def render_teachers(results: Mapping[str, Sequence[SeedResult]]) -> TextTable:
    """Return the table of teachers: medians of their lessons, and successes in each world."""
    worlds = [each.learned.world for each in next(iter(results.values()))[0].exams]
    table = TextTable(title="Teachers, medians of all seeds")
    headings = ("presses", "quartiles", "a minute", "RLAs", "collisions in lesson", *map(label_of, worlds))
    table.add_column("teacher, corrects by")
    for heading in headings:
        table.add_column(heading, number=True)
    for label, robots in results.items():
        low, presses, high = quartiles([each.lesson.presses for each in robots])
        minutes = robots[0].lesson.teaching_s / _MINUTE_S
        table.add_row(
            label,
            f"{presses:.0f}",
            f"{low:.0f} to {high:.0f}",
            f"{presses / minutes:.1f}",
            f"{quartiles([each.lesson.rlas for each in robots])[1]:.0f}",
            f"{quartiles([each.lesson.collisions for each in robots])[1]:.0f}",
            *(_successes(robots, place) for place in range(len(worlds))),
        )
    return table


def _successes(robots: Sequence[SeedResult], place: int) -> str:
    exams = [each.exams[place] for each in robots]
    judged = [each for each in exams if not not_judged(each)]
    return f"{sum(each.succeeded for each in judged)} of {len(judged)}"
