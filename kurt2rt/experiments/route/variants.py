"""Variants of teaching a route: the shipped one and its controls."""

from dataclasses import dataclass

from kurt2rt.core.mid.settings import load_mid_level
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan, plan_of

Phases = tuple[tuple[Phase, float], ...]


@dataclass(frozen=True, slots=True)
class Variant:
    """Variant of teaching a route."""

    name: str
    """Name in file names."""
    title: str
    commanded: bool = False
    """True if there is no mid level: the teacher commands at each junction."""
    radius: float | None = None
    """Another R of the mid level."""
    starts: int | None = None
    """Number of starts; None: the task's."""
    only_answers: bool = False
    """True if neither level is corrected."""
    corrects_basic: bool = True

    def task(self, task: TaskSettings) -> TaskSettings:
        """Return a copy of the task with the changes of the variant.

        Raises hal.settings.SettingsError if the task's mid level cannot be loaded.
        """
        if self.commanded or task.mid is None:
            return task.model_copy(update={"mid": None})
        mid = load_mid_level(task.mid)
        if self.radius is not None:
            mid = mid.model_copy(update={"learning": mid.learning.model_copy(update={"radius": self.radius})})
        return task.model_copy(update={"mid": mid})

    def plans(self, task: TaskSettings, starts: int) -> tuple[LessonPlan, ...]:
        """Return one plan for each start, in order: the task's whole lesson, cut into parts of equal length.

        Each part continues the phases where the part before ended.

        `starts`: number of parts, unless the variant sets its own.
        """
        whole = plan_of(task)
        starts = self.starts or starts
        phases = ((Phase.SUPERVISED, whole.duration_s),) if self.only_answers else whole.phases
        part_s = whole.duration_s / starts
        return tuple(
            LessonPlan(
                _part(phases, part * part_s, (part + 1) * part_s),
                purpose=f"route-{part + 1}",
                corrects_basic=self.corrects_basic,
            )
            for part in range(starts)
        )


def _part(phases: Phases, from_s: float, to_s: float) -> Phases:
    """Return the phases between two times in s."""
    part, begins_s = [], 0.0
    for phase, lasts_s in phases:
        ends_s = begins_s + lasts_s
        within_s = min(ends_s, to_s) - max(begins_s, from_s)
        if within_s > 0:
            part.append((phase, within_s))
        begins_s = ends_s
    return tuple(part)


TAUGHT = Variant("taught", "as shipped")
CONTROLS = (
    *(Variant(f"radius-{radius}", f"R = {radius}", radius=float(radius)) for radius in (0, 2, 4, 8, 12)),
    Variant("one-start", "begun at the start once", starts=1),
    Variant("only-answers", "questions are answered, nothing is corrected", only_answers=True),
    Variant("basic-not-corrected", "the basic level is answered, and not corrected", corrects_basic=False),
    Variant("commanded", "no mid level: a teacher commands at each junction, in the exam, too", commanded=True),
)
