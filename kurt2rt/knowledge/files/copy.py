"""A copy of a knowledge file, in one file, while a robot goes on writing it."""

from pathlib import Path

from kurt2rt.knowledge.files.atomic_write import SavedCopy, plain_part, stamp_part, write_numbered
from kurt2rt.knowledge.journal.journal import Journal

__all__ = ["SavedCopy", "save_copy"]


def save_copy(journal_path: Path, folder: Path, label: str, stamp: str) -> SavedCopy:
    """Copy the file as it stands at one moment: `<task>-<stamp>-<label>.knowledge`, a knowledge file like any other.

    `label` may be any text, `stamp` is UTC in ISO 8601. Waits for the disk: not for the thread that the robot runs in.
    Raises KnowledgeError.
    """
    with Journal.in_writer_process(journal_path) as journal:
        content = journal.image()
        task = journal.binding.system
    return write_numbered(content, folder, (plain_part(task), stamp_part(stamp), plain_part(label)), ".knowledge")
