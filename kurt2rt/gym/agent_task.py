"""Task of an environment: one behaviour, for which the agent takes the place of the RLAs."""

from hal.settings import SettingsError
from kurt2rt.core.task_settings import TaskSettings, load_task


def load_agent_task(name_or_path: str) -> TaskSettings:
    """Return a task without its mid level.

    Raises hal.settings.SettingsError for a missing or invalid file, or for a task with several behaviours.
    """
    task = load_task(name_or_path)
    if len(task.behaviours) > 1:
        raise SettingsError(
            f"task {task.name}: an environment has one behaviour (got {', '.join(task.behaviours)})",
            do="give a task with one, such as turn_left",
        )
    return task.model_copy(update={"mid": None})
