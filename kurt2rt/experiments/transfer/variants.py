"""Variants of teaching in a new world: the one that is studied and its controls."""

from dataclasses import dataclass, replace
from pathlib import Path

from kurt2rt.core.rla.phase import Phase
from kurt2rt.core.task_settings import TaskSettings, taught_by
from kurt2rt.core.teacher_settings import load_teacher
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan

PURPOSE = "new-world"
"""Purpose of the simulation in which a robot is taught on: another start and other noise than at home."""


@dataclass(frozen=True, slots=True)
class Variant:
    """Variant of teaching in a new world."""

    name: str
    """Name in file names."""
    title: str
    teacher: str | None = None
    """Name of another teacher in the new world; None: the teacher of home."""
    knows_home: bool = True
    """False: the robot begins in the new world without any knowledge."""

    def task(self, task: TaskSettings, world: str) -> TaskSettings:
        """Return the task to teach and examine in a new world, by its name.

        Raises hal.settings.SettingsError if the teacher cannot be loaded.
        """
        if self.teacher is not None:
            task = taught_by(task, load_teacher(self.teacher))
        teaching = task.teaching.model_copy(update={"world": world})
        exam = task.exam.model_copy(update={"worlds": (world,)})
        return task.model_copy(update={"teaching": teaching, "exam": exam})

    def plan(self, task: TaskSettings, seconds: float, most_presses: int) -> LessonPlan:
        """Return the plan of the lesson in the new world, which ends at `seconds` s or before another press.

        A robot with knowledge is corrected from the beginning; without knowledge it goes through phase 1 first.
        """
        supervised_s = 0.0 if self.knows_home else min(task.teaching.supervised_s, seconds)
        phases = ((Phase.SUPERVISED, supervised_s), (Phase.CORRECTIONS, seconds - supervised_s))
        return LessonPlan(tuple(each for each in phases if each[1]), purpose=PURPOSE, most_presses=most_presses)


TAUGHT_ON = Variant("taught-on", "home knowledge, taught on")


def taught_on_by(teacher: str | None) -> Variant:
    """Return the variant that is studied, with this teacher in the new world; None: the teacher of home."""
    if teacher is None:
        return TAUGHT_ON
    return replace(TAUGHT_ON, title=f"{TAUGHT_ON.title} by {Path(teacher).stem}", teacher=teacher)


CONTROLS = (
    Variant("answers-only", "control: questions are answered, nothing is corrected", teacher="answers_only"),
    Variant("from-nothing", "control: without the knowledge of home", knows_home=False),
)
