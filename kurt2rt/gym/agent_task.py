"""Task of an environment: one behaviour, for which the agent takes the place of the RLAs."""

from hal.settings import SettingsError
from kurt2rt.core.task_settings import TaskSettings, load_task


def load_agent_task(named: str | TaskSettings) -> TaskSettings:
    """Return a task without its mid level. `named`: its name or path, or the task itself.

    Raises hal.settings.SettingsError for a missing or invalid file, or for a task with several behaviours.
    """
    task = load_task(named) if isinstance(named, str) else named
    if len(task.behaviours) > 1:
        raise SettingsError(
            f"task {task.name}: an environment has one behaviour (got {', '.join(task.behaviours)})",
            do="give a task with one, such as turn_left",
        )
    return task.model_copy(update={"mid": None})
