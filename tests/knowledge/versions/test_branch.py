"""A branch begins as another file was, and knows whence it came."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from kurt2rt.core.rla.statistics import FIRST_VALUE, VALUES_INCLUDE, Statistics
from kurt2rt.knowledge.journal.entry import JournalEntry, StoredEntry
from kurt2rt.knowledge.journal.fold import check_knowledge
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.versions.branch import BranchOrigin, BranchResult, branch, branch_origin
from tests.knowledge.lessons import BINDING, STAMP, append, begun, created, deleted, replaced
from tests.knowledge.refusals import refused

LATER = "2004-04-26T11:00:00.000+00:00"
NOW = "2026-11-22T03:10:05.000+00:00"
COUNTED = Statistics(
    {1: 5, 2: 7, 3: 1},
    {(1, 2): 3, (2, 3): 1},
    {1: 0.25},
    {(1, 2): 95.0},
    {FIRST_VALUE: 0.5, VALUES_INCLUDE: 4.0},
    answer_delays={"Ann": (80, 90)},
)


@pytest.fixture
def taught(path: Path) -> Path:
    """Three RLAs, and an hour later the second one corrected."""
    with Journal.open(begun(path), BINDING) as journal:
        journal.append([JournalEntry(replaced(2, "left", "forward"), LATER)])
        journal.checkpoint(COUNTED)
    return path


def test_branch_whole_file_has_equal_lessons_and_counts(taught: Path, tmp_path: Path) -> None:
    made = branch(taught, tmp_path / "b.knowledge", None, stamp=NOW)
    told = made.origin
    assert made.skipped_earlier == 0
    with Journal.read_only(taught) as old, Journal.read_only(tmp_path / "b.knowledge") as new:
        assert new.entries() == old.entries()
        assert new.statistics() == old.statistics()
        assert new.binding == old.binding
        assert check_knowledge(new) == []
        assert branch_origin(new) == told == BranchOrigin("knowledge.db", 4, "replace-2-left", NOW)
        assert branch_origin(old) is None


@pytest.mark.parametrize("at", ["create-2", "2004-04-26T10:30+00:00"])
def test_branch_ends_with_a_lesson_or_at_a_time(taught: Path, tmp_path: Path, at: str) -> None:
    rows = 2 if at == "create-2" else 3
    branch(taught, tmp_path / "b", at, stamp=NOW)
    with Journal.read_only(tmp_path / "b") as new:
        assert new.events() == [created(number) for number in range(1, rows + 1)]
        counted = new.statistics()
        assert check_knowledge(new) == []
    uses = {1: 5} if rows == 2 else {1: 5, 3: 1}  # the second has another action since
    assert counted == Statistics(uses, numbers={FIRST_VALUE: 0.5}, answer_delays=COUNTED.answer_delays)


def test_branch_clock_set_back_ends_at_first_later_stamp(taught: Path, tmp_path: Path) -> None:
    with Journal.open(taught, BINDING) as journal:
        journal.append([JournalEntry(created(4), "2004-04-26T10:01:00.000+00:00"), JournalEntry(created(5), LATER)])
    made = branch(taught, tmp_path / "b", "2004-04-26T10:30+00:00", stamp=NOW)
    assert (made.origin.rows, made.skipped_earlier) == (3, 1)
    assert branch(taught, tmp_path / "c", "2004-04-26T11:00+00:00", stamp=NOW).skipped_earlier == 0
    assert branch(taught, tmp_path / "d", "create-4", stamp=NOW) == BranchResult(
        BranchOrigin(taught.name, 5, "create-4", NOW), 0
    )


def test_branch_invalid_stamp_is_refused(taught: Path, tmp_path: Path) -> None:
    with Journal.open(taught, BINDING) as journal:
        journal.append([JournalEntry(created(4), "yesterday")])
    with refused(KnowledgeCode.STAMP_INVALID):
        branch(taught, tmp_path / "b", "2004-04-26T10:30+00:00", stamp=NOW)


def test_branch_while_written_is_of_one_moment(taught: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with Journal.open(taught, BINDING) as robot:

        def taught_meanwhile(journal: Journal) -> Iterator[StoredEntry]:
            yield from iter_entries(journal)
            robot.append_and_checkpoint([JournalEntry(created(4), LATER)], replace(COUNTED, uses={4: 1}))

        iter_entries = Journal.iter_entries
        with monkeypatch.context() as meanwhile:
            meanwhile.setattr(Journal, "iter_entries", taught_meanwhile)
            branch(taught, tmp_path / "b", None, stamp=NOW)
    with Journal.read_only(tmp_path / "b") as new:
        assert (len(new.entries()), new.statistics()) == (4, COUNTED)


def test_branch_misfit_lessons_are_refused(taught: Path, tmp_path: Path) -> None:
    append(taught, deleted(77), stamp=LATER)
    with refused(KnowledgeCode.NOT_BUILT, taught, cause=KnowledgeCode.LESSON_MISFIT):
        branch(taught, tmp_path / "b", None, stamp=NOW)
    assert not (tmp_path / "b").exists()


def test_branch_before_the_first_lesson_is_empty(taught: Path, tmp_path: Path) -> None:
    assert branch(taught, tmp_path / "b", "1999-12-31", stamp=NOW).origin.rows == 0


def test_branch_existing_file_or_unknown_point_is_refused(taught: Path, tmp_path: Path) -> None:
    with refused(KnowledgeCode.ALREADY_THERE):
        branch(taught, taught, None, stamp=NOW)
    with refused(KnowledgeCode.NO_SUCH_POINT, taught, given="create-9"):
        branch(taught, tmp_path / "b", "create-9", stamp=NOW)
    (tmp_path / "c-wal").write_bytes(b"lessons")
    with refused(KnowledgeCode.FOREIGN_LOG, log="c-wal"):
        branch(taught, tmp_path / "c", None, stamp=NOW)
    assert not (tmp_path / "b").exists()
    assert not (tmp_path / "c").exists()


def test_branch_under_a_running_robot_can_be_taught(taught: Path, tmp_path: Path) -> None:
    with Journal.open(taught, BINDING):
        branch(taught, tmp_path / "b", None, stamp=NOW)
    with Journal.open(tmp_path / "b", BINDING) as journal:
        journal.append([JournalEntry(created(4), STAMP)])
        assert len(journal.events()) == 5


def test_branch_removes_temporary_file_of_a_kill(taught: Path, tmp_path: Path) -> None:
    (tmp_path / ".b.unborn").write_bytes(b"half a file")
    branch(taught, tmp_path / "b", None, stamp=NOW)
    assert not (tmp_path / ".b.unborn").exists()
    with Journal.read_only(tmp_path / "b") as journal:
        assert check_knowledge(journal) == []


def test_branch_unwritable_folder_is_refused(taught: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"")
    with refused(KnowledgeCode.FOLDER_NOT_MADE):
        branch(taught, tmp_path / "file" / "b", None, stamp=NOW)
