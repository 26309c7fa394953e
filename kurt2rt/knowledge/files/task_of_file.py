"""The task of a knowledge file: what it was taught for, checked against a task that is asked for."""

from pathlib import Path

from hal.settings import SettingsError
from kurt2rt.core.task_settings import load_task
from kurt2rt.knowledge.journal.journal import Journal
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
        asked = load_task(given).system_name
        if asked != taught:
            raise KnowledgeError(
                f"was taught for the task {taught!r}, not for {asked!r}",
                where=path,
                do="leave out --task, or give another knowledge file",
            )
        return given
    try:
        load_task(taught)
    except SettingsError as error:
        raise KnowledgeError(
            f"was taught for the task {taught!r}, whose settings are not found ({error})",
            where=path,
            do="give them: --task PATH.yaml",
        ) from error
    return taught
