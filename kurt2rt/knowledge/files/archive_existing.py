"""Archiving of an existing knowledge file, to make room for a new one at its path."""

from pathlib import Path

from kurt2rt.knowledge.journal import journal_file


def archive_existing(path: Path) -> Path | None:
    """Rename the file at `path` to `<name>.<number>` and return that; None if there is no file.

    Raises:
        KnowledgeError: another program writes the file.
    """
    if not path.exists():
        return None
    with journal_file.lock_for_writing(path):
        number = 1
        while (kept := path.with_name(f"{path.name}.{number}")).exists():
            number += 1
        log = journal_file.log_of(path)
        path.rename(kept)
        # After a crash only the log holds the newest lessons.
        if log.exists():
            log.rename(journal_file.log_of(kept))
    return kept
