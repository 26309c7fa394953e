"""Copies of the knowledge beside its file, made outside the loop while the robot goes on."""

from collections.abc import Callable
from pathlib import Path

import anyio.to_thread

from kurt2rt.knowledge.copy import SavedCopy, save_copy
from kurt2rt.knowledge.error import KnowledgeError
from kurt2rt.knowledge.table import export_table
from kurt2rt.knowledge.writer import JournalWriter, utc_now

_FLUSH_S = 5.0


class Safe:
    """What was taught until now is in the copy, or there is no copy."""

    def __init__(self, knowledge: Path, writer: JournalWriter) -> None:
        """Copies go to the folders `saved` and `exported` beside the knowledge file."""
        self._knowledge = knowledge
        self._writer = writer

    async def save(self, label: str) -> SavedCopy:
        """A copy of the knowledge file. Raises KnowledgeError."""
        return await self._copied(lambda: save_copy(self._knowledge, self._folder("saved"), label, utc_now()))

    async def export(self) -> SavedCopy:
        """The RLAs as a table. Raises KnowledgeError."""
        return await self._copied(lambda: export_table(self._knowledge, self._folder("exported"), utc_now()))

    async def _copied(self, copy: Callable[[], SavedCopy]) -> SavedCopy:
        def flush_and_copy() -> SavedCopy:
            if not self._writer.flush(_FLUSH_S):
                raise KnowledgeError(f"{self._knowledge}: the newest lessons are not saved yet; try again later")
            return copy()

        return await anyio.to_thread.run_sync(flush_and_copy)

    def _folder(self, name: str) -> Path:
        return self._knowledge.parent / name
