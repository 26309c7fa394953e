"""A new knowledge file that begins with lessons: whole on the disk, or not there at all."""

import math
import os
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.files.atomic_write import write_new
from kurt2rt.knowledge.journal import journal_file
from kurt2rt.knowledge.journal.binding import KnowledgeBinding
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.fold import fold_journal
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.platform.durable_files import make_private_folder


def create_knowledge(
    path: Path,
    binding: KnowledgeBinding,
    entries: Iterable[JournalEntry],
    statistics: Statistics,
    notes: Mapping[str, str],
    *,
    source: Path,
) -> None:
    """Make a knowledge file at `path`, where nothing may be, of what stands in the file `source`.

    Raises KnowledgeError that names `source` where its lessons do not fit, or one is in it twice.
    """
    log = journal_file.log_of(path)
    if log.exists() and log.stat().st_size > 0:  # SQLite would mix its lessons into the new file
        raise KnowledgeError(f"a log {log.name} of another file is beside it", where=path, do="give another path")
    image = _image_of(source, binding, tuple(entries), statistics, notes)
    try:
        make_private_folder(path.parent)
    except OSError as error:
        raise KnowledgeError(
            f"cannot be made ({error})", where=path.parent, do="give a file in another folder"
        ) from error
    with journal_file.lock_for_writing(path):  # a robot may begin a file there at this very moment
        write_new(image, path)


def _image_of(
    source: Path,
    binding: KnowledgeBinding,
    entries: Sequence[JournalEntry],
    statistics: Statistics,
    notes: Mapping[str, str],
) -> bytes:
    """The whole file, made and read again in a cradle of which nobody needs to hear."""
    try:
        with tempfile.TemporaryDirectory() as folder:
            cradle = Path(os.path.realpath(folder), "knowledge")
            try:
                _fill(cradle, binding, entries, statistics, notes)
                with Journal.read_only(cradle) as journal:
                    fold_journal(journal, radius=math.inf)
                    return journal.image()
            except KnowledgeError as error:
                problem = str(error).removeprefix(f"{cradle}: ")
                raise KnowledgeError(f"no knowledge file can be made of it: {problem}", where=source) from error
    except OSError as error:
        raise KnowledgeError(
            f"cannot be unpacked ({error})", where=source, do="make room where temporary files go"
        ) from error


def _fill(
    cradle: Path,
    binding: KnowledgeBinding,
    entries: Sequence[JournalEntry],
    statistics: Statistics,
    notes: Mapping[str, str],
) -> None:
    with Journal.open(cradle, binding) as journal:
        receipts = journal.append_and_checkpoint(entries, statistics)
        for number, receipt in enumerate(receipts, start=1):
            if not receipt.new:
                raise KnowledgeError(
                    f"row {number}: has the command id {receipt.command_id!r} of row {receipt.sequence}",
                    where=cradle,
                    do="keep the file, and get another copy",
                )
        for name, text in notes.items():
            journal.note(name, text)
