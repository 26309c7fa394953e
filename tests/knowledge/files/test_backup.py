"""Wait for the disk before a run may end."""

import hashlib
from pathlib import Path

import pytest

from kurt2rt.knowledge.files.atomic_write import SavedCopy
from kurt2rt.knowledge.files.backup import BackupService
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.writer import JournalWriter
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from tests.knowledge.lessons import BINDING, STAMP, created
from tests.knowledge.refusals import refused


def never(path: Path, folder: Path, stamp: str) -> SavedCopy:
    raise AssertionError((path, folder, stamp))


async def test_settle_failing_disk_is_refused_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.knowledge"
    with JournalWriter(Journal.open(path, BINDING), lambda: STAMP) as writer:
        safe = BackupService(path, writer, never)
        writer.submit(created(1))
        await safe.settle()
        assert writer.unwritten == 0
        monkeypatch.setattr(JournalWriter, "saving_error", property(lambda _: "the disk is full"))
        with refused(KnowledgeCode.NOT_DURABLE, reason="the disk is full"):
            await safe.settle()
        monkeypatch.undo()


async def test_read_of_a_made_copy_returns_its_parts(tmp_path: Path) -> None:
    path = tmp_path / "a.knowledge"
    with JournalWriter(Journal.open(path, BINDING), lambda: STAMP) as writer:
        service = BackupService(path, writer, never)
        writer.submit(created(1))
        made = await service.save("first")
        whole = await service.read(made.name, 0, 1 << 20)
        assert (whole.size_bytes, hashlib.sha256(whole.content).hexdigest()) == (made.size_bytes, made.sha256)
        assert (await service.read(made.name, 16, 4)).content == whole.content[16:20]
        with refused(KnowledgeCode.UNKNOWN_COPY, "a.knowledge"):
            await service.read("a.knowledge", 0, 16)
