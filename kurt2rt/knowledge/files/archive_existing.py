"""Makes room for new knowledge where earlier knowledge stands, without losing any of it."""

from pathlib import Path

from kurt2rt.knowledge.journal import journal_file


def archive_existing(path: Path) -> Path | None:
    """Give what stands at `path` a name with a number of its own, and return it; None where nothing stands.

    Raises KnowledgeError while another program writes the file.
    """
    if not path.exists():
        return None
    with journal_file.lock_for_writing(path):
        number = 1
        while (kept := path.with_name(f"{path.name}.{number}")).exists():
            number += 1
        log = journal_file.log_of(path)
        path.rename(kept)
        # After a crash the newest lessons stand in the log alone.
        if log.exists():
            log.rename(journal_file.log_of(kept))
    return kept
