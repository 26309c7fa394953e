"""Creation of a knowledge file that begins with lessons: whole on the disk, or not there at all."""

import math
import os
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.files.atomic_write import write_new
from kurt2rt.knowledge.journal import journal_file
from kurt2rt.knowledge.journal.binding import KnowledgeBinding
from kurt2rt.knowledge.journal.entry import JournalEntry, Receipt
from kurt2rt.knowledge.journal.fold import fold_journal
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.platform.durable_files import make_private_folder


def create_knowledge(
    path: Path,
    binding: KnowledgeBinding,
    entries: Sequence[JournalEntry],
    statistics: Statistics,
    notes: Mapping[str, str],
    *,
    source: Path,
) -> None:
    """Make a knowledge file at `path`, where no file may be, from the content of the file `source`.

    Args:
        path: of the new file.
        binding: features and task of the content.
        entries: lessons with their stamps, in order.
        statistics: counts and values after them.
        notes: texts about the file as a whole, by name.
        source: for errors.

    Raises:
        KnowledgeError: the file cannot be written, or, naming `source`, its lessons do not fit or one is in it twice.
    """
    log = journal_file.log_of(path)
    if log.exists() and log.stat().st_size > 0:  # SQLite would mix its lessons into the new file
        raise KnowledgeError(KnowledgeCode.FOREIGN_LOG, where=path, log=log.name)
    image = _build_image(source, binding, entries, statistics, notes)
    try:
        make_private_folder(path.parent)
    except OSError as error:
        raise KnowledgeError(KnowledgeCode.FOLDER_NOT_MADE, where=path.parent, error=error) from error
    with journal_file.lock_for_writing(path):  # a robot may make a file there at this very moment
        write_new(image, path)


def _build_image(
    source: Path,
    binding: KnowledgeBinding,
    entries: Sequence[JournalEntry],
    statistics: Statistics,
    notes: Mapping[str, str],
) -> bytes:
    """Build the file in a temporary folder, read it again to validate it, and return its bytes."""
    try:
        with tempfile.TemporaryDirectory() as folder:
            temp_file = Path(os.path.realpath(folder), "knowledge")
            try:
                with Journal.open(temp_file, binding) as journal:
                    _require_new(journal.append(entries, statistics), temp_file)
                    for name, text in notes.items():
                        journal.note(name, text)
                with Journal.read_only(temp_file) as journal:
                    fold_journal(journal, radius=math.inf)
                    return journal.image()
            except KnowledgeError as error:
                reason = str(error).removeprefix(f"{temp_file}: ")
                raise KnowledgeError(KnowledgeCode.NOT_BUILT, where=source, reason=reason, cause=error.code) from error
    except OSError as error:
        raise KnowledgeError(KnowledgeCode.NO_TEMPORARY_FILES, where=source, error=error) from error


def _require_new(receipts: Sequence[Receipt], path: Path) -> None:
    for number, receipt in enumerate(receipts, start=1):
        if not receipt.new:
            where, command_id = f"{path}: row {number}", receipt.command_id
            raise KnowledgeError(
                KnowledgeCode.DUPLICATE_COMMAND, where=where, command_id=command_id, row=receipt.sequence
            )
