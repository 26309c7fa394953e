"""Whether a task can be taught and examined where it is to be."""

from collections.abc import Iterable

from hal.settings import SettingsError
from kurt2rt.experiments.arena import Stage
from kurt2rt.tasks.settings import TaskSettings


def require_course(stage: Stage, task: TaskSettings, worlds: Iterable[str]) -> None:
    """Look, before anything is taught, whether each of these worlds has what the task's course needs.

    Raises hal.settings.SettingsError that names task, course and world.
    """
    for world in dict.fromkeys(worlds):
        try:
            task.course.require(stage.plan_of(world), task.behaviours)
        except SettingsError as error:
            raise SettingsError(f"task {task.name}: {error}") from error
