import shutil
from pathlib import Path

from kurt2rt.knowledge.files.archive_existing import archive_existing
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.journal_file import log_of
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from tests.knowledge.lessons import BINDING, begun, created, entry
from tests.knowledge.refusals import refused


def killed(path: Path, lessons: int) -> Path:
    """A knowledge file as a killed program leaves it: the lessons stand in SQLite's log alone."""
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


def test_knowledge_stays_under_a_number_of_its_own(path: Path) -> None:
    for lessons in (1, 2, 3):
        archive_existing(begun(path, lessons))
        assert not path.exists()
    assert [stored(path.with_name(f"{path.name}.{number}")) for number in (1, 2, 3)] == [1, 2, 3]


def test_lessons_of_a_killed_program_go_along(path: Path) -> None:
    archive_existing(killed(path, lessons=4))
    assert stored(begun(path, lessons=1)) == 1
    assert stored(path.with_name(f"{path.name}.1")) == 4


def test_knowledge_in_use_is_left_where_it_is(path: Path) -> None:
    with Journal.open(begun(path), BINDING):
        with refused(KnowledgeCode.ANOTHER_WRITER):
            archive_existing(path)
        assert path.exists()


def test_where_nothing_is_nothing_is_done(path: Path) -> None:
    archive_existing(path)
    assert list(path.parent.iterdir()) == []
