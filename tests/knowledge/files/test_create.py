"""A knowledge file is made whole, or not at all."""

from pathlib import Path

import pytest

from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.files.create import create_knowledge
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from tests.knowledge.lessons import BINDING, begun, entry
from tests.knowledge.refusals import refused


def create(path: Path) -> None:
    create_knowledge(path, BINDING, [entry(1), entry(2)], Statistics({1: 5}), {"came": "by post"}, source=Path("a.zip"))


def test_create_where_something_is_in_the_way_is_refused(path: Path, tmp_path: Path) -> None:
    with refused(KnowledgeCode.ALREADY_THERE):
        create(begun(path))
    (tmp_path / "other-wal").write_bytes(b"lessons")
    with refused(KnowledgeCode.FOREIGN_LOG, log="other-wal"):
        create(tmp_path / "other")
    with refused(KnowledgeCode.FOLDER_NOT_MADE):
        create(path / "other")
    assert not (tmp_path / "other").exists()


def test_create_without_room_for_temporary_files_is_refused(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(path.parent / "nowhere"))
    with refused(KnowledgeCode.NO_TEMPORARY_FILES):
        create(path)
