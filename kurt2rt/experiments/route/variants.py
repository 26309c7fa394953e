"""What is taught and driven, and what it is compared with."""

from dataclasses import dataclass

from kurt2rt.experiments.lesson_plan import LessonPlan, plan_of
from kurt2rt.mid.settings import load_mid
from kurt2rt.rla.rla import Phase
from kurt2rt.tasks.settings import TaskSettings


@dataclass(frozen=True, slots=True)
class Variant:
    """One way to teach the same route."""

    name: str
    """In names of files."""
    title: str
    mid: str | None = ""
    """Another mid level by name; None: none, somebody commands at each junction; empty: the task's own."""
    radius: float | None = None
    """Another R of the mid level."""
    only_answers: bool = False
    """Nothing is corrected at either level."""
    corrects_basic: bool = True

    def task(self, task: TaskSettings) -> TaskSettings:
        """The task with what is different."""
        if self.mid is None or task.mid is None:
            return task.model_copy(update={"mid": None})
        mid = load_mid(self.mid or task.mid)
        if self.radius is not None:
            mid = mid.model_copy(update={"learning": mid.learning.model_copy(update={"radius": self.radius})})
        return task.model_copy(update={"mid": mid})

    def plan(self, task: TaskSettings) -> LessonPlan:
        """Its lesson."""
        plan = plan_of(task)
        phases = ((Phase.SUPERVISED, plan.duration_s),) if self.only_answers else plan.phases
        return LessonPlan(phases, purpose="route", corrects_basic=self.corrects_basic)


TAUGHT = Variant("taught", "as shipped")
CONTROLS = (
    Variant("only-answers", "questions are answered, nothing is corrected", only_answers=True),
    Variant("basic-not-corrected", "the mid level is taught, the basic level only answered", corrects_basic=False),
    Variant("commanded", "no mid level: somebody commands at each junction, in the exam, too", mid=None),
    *(Variant(f"radius-{radius}", f"R = {radius}", radius=float(radius)) for radius in (0, 2, 4, 8, 12)),
)
