"""Backups of a knowledge file next to it, made outside the loop while the robot goes on."""

from collections.abc import Callable
from pathlib import Path

import anyio.to_thread

from kurt2rt.knowledge.files.atomic_write import SavedCopy, plain_part, stamp_part, write_numbered
from kurt2rt.knowledge.files.table import export_table
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.writer import JournalWriter, utc_now
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.platform.file_part import FilePart, read_part

_FLUSH_S = 5.0

Package = Callable[[Path, Path, str], SavedCopy]
"""Makes a package of a knowledge file: its path, folder of the package, stamp. Raises KnowledgeError."""


Examine = Callable[[Path, Path], None]
"""Begins an exam of the copy at the first path, which it deletes at the end; the picture gets the second path.

Raises KnowledgeError.
"""


def save_copy(journal_path: Path, folder: Path, label: str, stamp: str) -> SavedCopy:
    """Save a knowledge file with all that the one at `journal_path` holds at one moment, while a robot writes it.

    Args:
        journal_path: of the file; this very process may be its writer.
        folder: of the copy `<task>-<stamp>-<label>.knowledge`; made if it is missing.
        label: any text.
        stamp: UTC, ISO 8601.

    Raises:
        KnowledgeError: the file cannot be read, or the copy not be written.
    """
    with Journal.in_writer_process(journal_path) as journal:
        content = journal.image()
        task = journal.binding.system
    return write_numbered(content, folder, (plain_part(task), stamp_part(stamp), plain_part(label)), ".knowledge")


class BackupService:
    """Maker of copies that hold all that was taught before the call. All methods raise KnowledgeError."""

    def __init__(
        self,
        knowledge: Path,
        writer: JournalWriter,
        package: Package,
        examine: Examine | None = None,
        picture: Path | None = None,
    ) -> None:
        """Put copies into the folders `saved` and `exported` next to the knowledge file, exams into `exams`.

        Args:
            knowledge: file that is copied.
            writer: of the file.
            package: makes a package of it.
            examine: None: this robot is not examined.
            picture: of an exam in an earlier run, which can be read, too.
        """
        self._examine = examine
        self._knowledge = knowledge
        self._writer = writer
        self._package = package
        self._made: dict[str, Path] = {} if picture is None else {picture.name: picture}

    async def save(self, label: str) -> SavedCopy:
        """Save a copy of the knowledge file, with `label` in its name. Raises KnowledgeError."""
        return await self._copied("saved", lambda folder: save_copy(self._knowledge, folder, label, utc_now()))

    async def export(self) -> SavedCopy:
        """Save the RLAs as a table. Raises KnowledgeError."""
        return await self._copied("exported", lambda folder: export_table(self._knowledge, folder, utc_now()))

    async def package(self) -> SavedCopy:
        """Save all of the knowledge as a package for others. Raises KnowledgeError."""
        return await self._copied("exported", lambda folder: self._package(self._knowledge, folder, utc_now()))

    async def examine(self) -> None:
        """Begin an exam of a copy of the knowledge file. Raises KnowledgeError."""
        examine = self._examine
        if examine is None:
            raise KnowledgeError(KnowledgeCode.NOT_SIMULATED)
        examined = await self._copied("exams", lambda folder: save_copy(self._knowledge, folder, "", utc_now()))
        copy = self._made.pop(examined.name)
        picture = copy.with_suffix(".png")
        await anyio.to_thread.run_sync(examine, copy, picture)
        self._made[picture.name] = picture

    async def settle(self) -> None:
        """Wait until all that was taught is durable. Raises KnowledgeError."""
        if self._writer.saving_error is not None:
            raise KnowledgeError(KnowledgeCode.NOT_DURABLE, reason=self._writer.saving_error)
        await anyio.to_thread.run_sync(self._flush)

    async def read(self, name: str, offset: int, most_bytes: int) -> FilePart:
        """Return up to `most_bytes` of a copy from `offset` on.

        Raises:
            KnowledgeError: this object made no copy of that name, or it cannot be read.
        """
        path = self._made.get(name)
        if path is None:
            raise KnowledgeError(KnowledgeCode.UNKNOWN_COPY, where=name)
        return await anyio.to_thread.run_sync(_read, path, offset, most_bytes)

    async def _copied(self, folder_name: str, copy: Callable[[Path], SavedCopy]) -> SavedCopy:
        folder = self._knowledge.parent / folder_name

        def flush_and_copy() -> SavedCopy:
            self._flush()
            return copy(folder)

        made = await anyio.to_thread.run_sync(flush_and_copy)
        self._made[made.name] = folder / made.name
        return made

    def _flush(self) -> None:
        if not self._writer.flush(_FLUSH_S):
            raise KnowledgeError(KnowledgeCode.NOT_YET_DURABLE, where=self._knowledge)


def _read(path: Path, offset: int, most_bytes: int) -> FilePart:
    try:
        return read_part(path, offset, most_bytes)
    except OSError as error:
        raise KnowledgeError(KnowledgeCode.COPY_UNREADABLE, where=path, error=error.strerror) from error
