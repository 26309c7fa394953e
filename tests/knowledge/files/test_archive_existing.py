import shutil
from pathlib import Path

from kurt2rt.knowledge.files.archive_existing import archive_existing
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.journal_file import log_of
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from tests.knowledge.lessons import BINDING, begun, created, entry
from tests.knowledge.refusals import refused


def killed(path: Path, lessons: int) -> Path:
    """Make a knowledge file as a killed program leaves it, with the lessons only in SQLite's log; return its path."""
    with Journal.open(path, BINDING) as journal:
        journal.append([entry(number) for number in range(1, lessons + 1)])
        shutil.copy(path, path.with_name("crashed"))
        shutil.copy(log_of(path), log_of(path.with_name("crashed")))
    path.unlink()
    path.with_name("crashed").rename(path)
    log_of(path.with_name("crashed")).rename(log_of(path))
    return path


def stored(path: Path) -> int:
    with Journal.open(path, BINDING) as journal:
        assert journal.events() == [created(number) for number in range(1, len(journal.events()) + 1)]
        return len(journal.events())


def test_archive_existing_numbers_each_file(path: Path) -> None:
    for lessons in (1, 2, 3):
        archive_existing(begun(path, lessons))
        assert not path.exists()
    assert [stored(path.with_name(f"{path.name}.{number}")) for number in (1, 2, 3)] == [1, 2, 3]


def test_archive_existing_moves_the_log(path: Path) -> None:
    archive_existing(killed(path, lessons=4))
    assert stored(begun(path, lessons=1)) == 1
    assert stored(path.with_name(f"{path.name}.1")) == 4


def test_archive_existing_file_in_use_is_refused(path: Path) -> None:
    with Journal.open(begun(path), BINDING):
        with refused(KnowledgeCode.ANOTHER_WRITER):
            archive_existing(path)
        assert path.exists()
