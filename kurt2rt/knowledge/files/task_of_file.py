"""Task of a knowledge file, checked against a task that an option names."""

from pathlib import Path

from hal.plugins import settings_from_elsewhere
from hal.robot_plugins import robots_task
from hal.settings import SettingsError
from kurt2rt.core.task_settings import load_task
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError


def task_of_file(path: Path, given: str | None = None) -> str:
    """Return the name or path of the task to use the knowledge in `path` for.

    Args:
        given: a task by name or path, of --task; None: the task that the file names.

    Raises:
        KnowledgeError: the file cannot be read, was taught for another task than `given`, or names a task that is not
            among the shipped ones.
        SettingsError: there is no task `given`.
    """
    with Journal.read_only(path) as journal:
        taught = journal.binding.system
    if given is not None:
        wanted = load_task(given).system_name
        if wanted != taught:
            raise KnowledgeError(KnowledgeCode.OTHER_TASK_GIVEN, where=path, taught=taught, wanted=wanted)
        return given
    try:
        with settings_from_elsewhere():  # the file may be of anyone, and the name in it a module's
            load_task(taught)
    except SettingsError as error:
        of_robot = robots_task(taught)
        if of_robot is None:
            raise KnowledgeError(KnowledgeCode.TASK_NOT_FOUND, where=path, taught=taught, error=error) from error
        return of_robot
    return taught
