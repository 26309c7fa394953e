"""Copies of the knowledge beside its file, made outside the loop while the robot goes on."""

from collections.abc import Callable
from pathlib import Path

import anyio.to_thread

from kurt2rt.knowledge.files.copy import SavedCopy, save_copy
from kurt2rt.knowledge.files.table import export_table
from kurt2rt.knowledge.journal.writer import JournalWriter, utc_now
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.platform.file_part import FilePart, read_part

_FLUSH_S = 5.0

Package = Callable[[Path, Path, str], SavedCopy]
"""Makes one file to give away of a knowledge file: its path, folder of the new file, stamp. Raises KnowledgeError."""


Examine = Callable[[Path, Path], None]
"""Begins an exam of the copy at the first path, which it deletes at the end; the picture gets the second path.

Raises KnowledgeError.
"""


class BackupService:
    """What was taught until now is in the copy, or there is no copy."""

    def __init__(
        self, knowledge: Path, writer: JournalWriter, package: Package, examine: Examine | None = None
    ) -> None:
        """Copies go to the folders `saved` and `exported` next to the knowledge file, exams to `exams`.

        `examine`: None: this robot is not examined.
        """
        self._examine = examine
        self._knowledge = knowledge
        self._writer = writer
        self._package = package
        self._made: dict[str, Path] = {}

    async def save(self, label: str) -> SavedCopy:
        """A copy of the knowledge file. Raises KnowledgeError."""
        return await self._copied("saved", lambda folder: save_copy(self._knowledge, folder, label, utc_now()))

    async def export(self) -> SavedCopy:
        """The RLAs as a table. Raises KnowledgeError."""
        return await self._copied("exported", lambda folder: export_table(self._knowledge, folder, utc_now()))

    async def package(self) -> SavedCopy:
        """All of the knowledge as one file to give away. Raises KnowledgeError."""
        return await self._copied("exported", lambda folder: self._package(self._knowledge, folder, utc_now()))

    async def examine(self) -> None:
        """Begin an exam of a copy of the knowledge file. Raises KnowledgeError."""
        examine = self._examine
        if examine is None:
            raise KnowledgeError("this robot is not simulated here", do="examine its knowledge with kurt2rt exam")
        examined = await self._copied("exams", lambda folder: save_copy(self._knowledge, folder, "", utc_now()))
        copy = self._made.pop(examined.name)
        picture = copy.with_suffix(".png")
        await anyio.to_thread.run_sync(examine, copy, picture)
        self._made[picture.name] = picture

    async def settle(self) -> None:
        """Wait until all that was taught is durable. Raises KnowledgeError."""
        if self._writer.error is not None:
            raise KnowledgeError(self._writer.error)
        await anyio.to_thread.run_sync(self._flush)

    async def read(self, name: str, offset: int, most_bytes: int) -> FilePart:
        """Return up to `most_bytes` of a copy from `offset` on.

        Raises KnowledgeError for a name that none of the copies made by this object has, and where it cannot be read.
        """
        path = self._made.get(name)
        if path is None:
            raise KnowledgeError("is no copy of this run of the program", where=name, do="save or export again")
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
            raise KnowledgeError("the newest lessons are not saved yet", where=self._knowledge, do="try again later")


def _read(path: Path, offset: int, most_bytes: int) -> FilePart:
    try:
        return read_part(path, offset, most_bytes)
    except OSError as error:
        raise KnowledgeError(f"cannot be read ({error.strerror})", where=path, do="save or export again") from error
