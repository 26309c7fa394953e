"""A new knowledge file that begins with lessons: whole on the disk, or not there at all."""

import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path

from kurt2rt.knowledge import journal_file
from kurt2rt.knowledge.binding import KnowledgeBinding
from kurt2rt.knowledge.entry import JournalEntry
from kurt2rt.knowledge.error import KnowledgeError
from kurt2rt.knowledge.journal import Journal
from kurt2rt.knowledge.saved_copy import save_new
from kurt2rt.knowledge.statistics import Statistics


def bear(
    path: Path,
    binding: KnowledgeBinding,
    entries: Iterable[JournalEntry],
    statistics: Statistics,
    notes: Mapping[str, str],
) -> None:
    """Make a knowledge file at `path`, where nothing may be. Raises KnowledgeError."""
    log = journal_file.log_of(path)
    if log.exists() and log.stat().st_size > 0:  # SQLite would mix its lessons into the new file
        raise KnowledgeError(f"{path}: a log {log.name} of another file is beside it; give another path")
    with tempfile.TemporaryDirectory() as folder:
        cradle = Path(folder) / path.name
        with Journal.open(cradle, binding) as journal:
            journal.append_and_checkpoint(tuple(entries), statistics)
            for name, text in notes.items():
                journal.note(name, text)
        with Journal.read_only(cradle) as journal:
            image = journal.image()
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise KnowledgeError(f"{path.parent}: cannot be made ({error}); give a file in another folder") from error
    with journal_file.lock_for_writing(path):  # a robot may begin a file there at this very moment
        save_new(image, path)
