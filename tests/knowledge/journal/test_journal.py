import shutil
import sqlite3
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.statistics import BEST_SCORE, Statistics
from kurt2rt.knowledge.journal import journal_file
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from tests.cli.helpers import ROOT, started
from tests.knowledge.lessons import BINDING, STAMP, begun, created, deleted, entry, replaced, tamper
from tests.knowledge.refusals import refused


def test_append_lessons_are_there_after_close(path: Path) -> None:
    lessons: list[TeachingEvent] = [created(1), created(2), replaced(1, "left", instead_of="forward"), deleted(2)]
    with Journal.open(path, BINDING) as journal:
        receipts = journal.append([JournalEntry(lesson, STAMP) for lesson in lessons])
        assert [(receipt.sequence, receipt.new) for receipt in receipts] == [(n, True) for n in (1, 2, 3, 4)]

    with Journal.open(path, BINDING) as journal:
        assert journal.events() == lessons
        assert len(journal.entries()) == 4
        assert {stored.stamped_at for stored in journal.entries()} == {STAMP}
        assert journal.check() == []
        assert journal.binding == BINDING


def test_append_repeated_command_is_written_once(path: Path) -> None:
    with Journal.open(path, BINDING) as journal:
        journal.append([entry(1)])
        again, fresh, twice = journal.append([entry(1), entry(2), entry(2)])

        assert (again.sequence, again.new, again.agrees) == (1, False, True)
        assert (fresh.sequence, fresh.new, fresh.agrees) == (2, True, True)
        assert (twice.sequence, twice.new, twice.agrees) == (2, False, True)
        assert journal.events() == [created(1), created(2)]


def test_append_other_lesson_of_known_command_disagrees(path: Path) -> None:
    with Journal.open(path, BINDING) as journal:
        journal.append([entry(1)])
        (receipt,) = journal.append([JournalEntry(created(2, command_id="create-1"), STAMP)])

        assert (receipt.sequence, receipt.new, receipt.agrees) == (1, False, False)
        assert journal.events() == [created(1)]


def test_append_batch_is_all_or_nothing(path: Path) -> None:
    unwritable = replace(created(2).rla, condition=(float("nan"),))
    with Journal.open(path, BINDING) as journal:
        with refused(KnowledgeCode.EVENT_NOT_WRITABLE):
            journal.append([entry(1), JournalEntry(replace(created(2), rla=unwritable), STAMP)])

        assert journal.events() == []
        journal.append([entry(1)])
        assert journal.events() == [created(1)]


def test_open_every_commit_is_synced(path: Path) -> None:
    with Journal.open(path, BINDING) as journal:
        assert journal._connection.execute("PRAGMA synchronous").fetchone() == (2,)
        assert journal._connection.execute("PRAGMA journal_mode").fetchone() == ("wal",)


def test_lesson_table_refuses_changes_and_deletions(path: Path) -> None:
    begun(path)
    for statement in ("DELETE FROM lesson", "UPDATE lesson SET stamped_at = ''"):
        with pytest.raises(sqlite3.IntegrityError, match="lessons are never"):
            tamper(path, statement)


def test_statistics_are_those_of_the_last_checkpoint(path: Path) -> None:
    first = Statistics({1: 5, 2: 7}, {(1, 2): 4, (2, 1): 3}, {1: 0.5, 2: -1 / 3}, {"a": 90.0, "b": 0.1 + 0.2})
    second = Statistics({1: 6, 3: 1}, {(1, 2): 4, (1, 3): 1}, {1: 0.5, 3: 5e-324}, {"a": 81.0, "c": 1e300})
    with Journal.open(path, BINDING) as journal:
        assert journal.statistics() == Statistics()
        journal.checkpoint(first)
        assert journal.statistics() == first  # to the last bit
        journal.checkpoint(second)
        journal.checkpoint(second)
    with Journal.read_only(path) as journal:
        assert journal.statistics() == second


def test_checkpoint_writes_only_changed_rows_without_reading(path: Path) -> None:
    with Journal.open(path, BINDING) as journal:
        journal.checkpoint(Statistics({1: 5}, numbers={BEST_SCORE: 0.25}))
        statements: list[str] = []
        journal._connection.set_trace_callback(statements.append)
        journal.checkpoint(Statistics({1: 6}, numbers={BEST_SCORE: 0.25}))
        journal.checkpoint(Statistics({1: 6}, numbers={BEST_SCORE: 0.25}))
        assert statements == ["BEGIN IMMEDIATE", "INSERT OR REPLACE INTO uses VALUES (1, 6)", "COMMIT"]


def test_checkpoint_after_a_failed_one_writes_all(path: Path) -> None:
    with Journal.open(path, BINDING) as journal:
        journal.checkpoint(Statistics({1: 5}))
        journal._connection.execute("PRAGMA query_only = ON")
        with pytest.raises(KnowledgeError):
            journal.checkpoint(Statistics({1: 6}))
        journal._connection.execute("PRAGMA query_only = OFF")
        journal.checkpoint(Statistics({1: 6}))
        assert journal.statistics() == Statistics({1: 6})


def test_append_with_statistics_is_one_transaction(path: Path) -> None:
    unwritable = replace(created(2).rla, condition=(float("nan"),))
    with Journal.open(path, BINDING) as journal:
        with refused(KnowledgeCode.EVENT_NOT_WRITABLE):
            journal.append([JournalEntry(replace(created(2), rla=unwritable), STAMP)], Statistics({1: 1}))
        assert journal.statistics() == Statistics()
        journal.append([entry(1)], Statistics(values={1: 0.25}))
        assert journal.statistics() == Statistics(values={1: 0.25})


def test_statistics_missing_table_is_refused(path: Path) -> None:
    tamper(begun(path), "DROP TABLE uses")
    with Journal.read_only(path) as look, refused(KnowledgeCode.SQLITE_REFUSES):
        look.statistics()


def test_read_only_sees_lessons_while_a_robot_writes(path: Path) -> None:
    with Journal.open(path, BINDING) as journal, Journal.read_only(path) as look:
        assert look.binding == BINDING
        journal.append([entry(1)])
        assert look.events() == [created(1)]
        journal.append([entry(2)])
        assert look.events() == [created(1), created(2)]
        assert look.check() == []
        with refused(KnowledgeCode.READ_ONLY):
            look.append([entry(3)])


def contents(folder: Path) -> dict[str, bytes]:
    return {each.name: each.read_bytes() for each in folder.iterdir()}


def test_read_only_leaves_folder_unchanged(path: Path) -> None:
    before = contents(begun(path).parent)
    with Journal.read_only(path) as look, Journal.read_only(path) as another:
        assert look.check() == []
        assert look.events() == another.events()
        with refused(KnowledgeCode.READ_ONLY):
            look.append([entry(4)])
    assert contents(path.parent) == before


def test_read_only_leaves_the_log_of_a_killed_robot(tmp_path: Path, path: Path) -> None:
    killed = tmp_path / "killed"
    with Journal.open(path, BINDING) as journal:
        journal.append([entry(1)])
        with Journal.read_only(path) as look:
            assert look.events() == [created(1)]
        assert journal_file.log_of(path).stat().st_size > 0
        journal.append([entry(2)])
        shutil.copytree(path.parent, killed, ignore=shutil.ignore_patterns(killed.name))
    before = contents(killed)
    with Journal.read_only(killed / path.name) as look:
        assert look.events() == [created(1), created(2)]
    after = contents(killed)
    for each in (path.name, f"{path.name}-wal"):
        assert after[each] == before[each]


def read_without_rights(path: Path) -> tuple[str, str]:
    """Return the standard output and error of a reader without rights."""
    with started("tests.knowledge.read_without_rights", str(path), folder=ROOT) as look:
        return look.communicate()


def test_read_only_without_rights_in_the_folder_is_read() -> None:
    with TemporaryDirectory() as folder:  # not tmp_path: its parents are private
        path = begun(Path(folder) / "knowledge.db")
        Path(folder).chmod(0o555)
        assert read_without_rights(path) == ("3\n", "")
        Path(folder).chmod(0o755)
        assert set(contents(Path(folder))) == {path.name, f"{path.name}.lock"}
