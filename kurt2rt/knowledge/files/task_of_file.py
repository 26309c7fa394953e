"""Task of a knowledge file, checked against a task that an option names."""

from pathlib import Path

from config.settings import SettingsError
from kurt2rt.core.task_settings import installed_task, load_task
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError


def task_of_file(path: Path, given: str | None = None) -> str:
    """Return the name or path of the task to use the knowledge in `path` for.

    Args:
        given: a task by name or path, of --task; None: the task that the file names.

    Raises:
        KnowledgeError: the file cannot be read, was taught for another task than `given`, or names a task that is
            neither shipped nor installed.
        SettingsError: there is no task `given`.
    """
    taught = system_of_file(path)
    if given is None:
        return task_of_elsewhere(taught, path)
    wanted = load_task(given).system_name
    if wanted != taught:
        raise KnowledgeError(KnowledgeCode.OTHER_TASK_GIVEN, where=path, taught=taught, wanted=wanted)
    return given


def system_of_file(path: Path) -> str:
    """Return the name of the RLA system that a knowledge file holds. Raises KnowledgeError."""
    with Journal.read_only(path) as journal:
        return journal.binding.system


def task_of_elsewhere(named: str, path: Path) -> str:
    """Return the name for `load_task` of the task that the file `path`, maybe a stranger's, names.

    Raises KnowledgeError if the task is neither shipped nor installed; the error asks for --task.
    """
    try:
        return installed_task(named)
    except SettingsError as error:
        raise KnowledgeError(KnowledgeCode.TASK_NOT_FOUND, where=path, taught=named, error=error.what) from error
