"""A copy of the knowledge while the robot goes on writing it."""

import hashlib
import subprocess
import sys
from pathlib import Path

import pytest

from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.files.backup import save_copy
from kurt2rt.knowledge.files.table import export_table
from kurt2rt.knowledge.journal import journal_file
from kurt2rt.knowledge.journal.fold import check_knowledge
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.writer import JournalWriter
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from tests.cli.helpers import ROOT, started
from tests.knowledge.journal.test_writer import largest_file
from tests.knowledge.lessons import BINDING, STAMP, begun, created, entry, tamper
from tests.knowledge.refusals import refused


def names(folder: Path) -> list[str]:
    return sorted(each.name for each in folder.iterdir())


def test_save_copy_holds_all_acknowledged_lessons(path: Path, tmp_path: Path) -> None:
    folder = tmp_path / "saved"
    with Journal.open(path, BINDING) as journal:
        journal.append([entry(number) for number in range(1, 81)])
        journal.checkpoint(Statistics({1: 5}, {(1, 2): 3}))
        assert journal_file.log_of(path).stat().st_size > path.stat().st_size  # most of it stands in the log

        saved = save_copy(path, folder, "First try", STAMP)
        journal.append([entry(81)])

    assert saved.name == "wall-following-20040426T100000-first-try.knowledge"
    assert names(folder) == [saved.name]
    content = (folder / saved.name).read_bytes()
    assert (saved.sha256, saved.size_bytes) == (hashlib.sha256(content).hexdigest(), len(content))
    with Journal.read_only(folder / saved.name) as look:
        assert check_knowledge(look) == []
        assert look.binding == BINDING
        assert look.events() == [created(number) for number in range(1, 81)]
        assert look.statistics() == Statistics({1: 5}, {(1, 2): 3})
    assert names(folder) == [saved.name]  # a look needs no second file
    with Journal.open(folder / saved.name, BINDING) as taught_on:
        taught_on.append([entry(81)])
        assert taught_on.check() == []


def test_save_copy_while_lessons_come_is_whole(path: Path, tmp_path: Path) -> None:
    with JournalWriter(Journal.open(path, BINDING), now=lambda: STAMP) as writer:
        for number in range(1, 121):
            writer.submit(created(number))
            if number % 10 == 0:
                save_copy(path, tmp_path / "saved", f"after {number}", STAMP)
    for copy in (tmp_path / "saved").iterdir():
        with Journal.read_only(copy) as look:
            events = look.events()
            assert check_knowledge(look) == []
        assert events == [created(number) for number in range(1, len(events) + 1)]


OTHER_PROGRAM = """
import sqlite3, sys
connection = sqlite3.connect(sys.argv[1])
print(connection.execute("SELECT count(*) FROM lesson").fetchone()[0])
connection.close()
"""


@pytest.mark.parametrize(
    "take", [lambda path, to: save_copy(path, to, "", STAMP), lambda path, to: export_table(path, to, STAMP)]
)
def test_save_copy_writer_in_the_process_keeps_its_locks(path: Path, tmp_path: Path, take: object) -> None:
    """The last program that closes would remove the log otherwise, and later lessons with it."""
    assert callable(take)
    with Journal.open(path, BINDING) as journal:
        journal.append([entry(1)])
        log = journal_file.identities(path)
        take(path, tmp_path / "saved")
        other = subprocess.run([sys.executable, "-c", OTHER_PROGRAM, str(path)], capture_output=True, check=True)
        assert other.stdout == b"1\n"
        assert journal_file.identities(path) == log
        journal.append([entry(2)])


@pytest.mark.parametrize(
    ("label", "part"),
    [
        *(("First try!", "-first-try"), ("../../etc/passwd", "-etc-passwd")),
        *(("K\N{LATIN SMALL LETTER U WITH DIAERESIS}che", "-kuche"), ("", ""), ("\N{ROBOT FACE}\n\0/", "")),
        *(("-a--b-", "-a-b"), ("x" * 31 + "-yz", "-" + "x" * 31), ("x" * 1000, "-" + "x" * 32)),
    ],
)
def test_save_copy_name_is_safe_for_any_label(path: Path, tmp_path: Path, label: str, part: str) -> None:
    saved = save_copy(begun(path), tmp_path / "saved", label, STAMP)

    assert saved.name == f"wall-following-20040426T100000{part}.knowledge"
    assert names(tmp_path / "saved") == [saved.name]


def test_save_copy_taken_name_gets_a_number(path: Path, tmp_path: Path) -> None:
    folder = tmp_path / "saved"
    first = save_copy(begun(path), folder, "x", STAMP)
    (folder / "wall-following-20040426T100000-x-2.knowledge").symlink_to("nowhere")
    (folder / ".wall-following-20040426T100000-x-3.knowledge.unborn").write_bytes(b"half of it, then a kill")
    third = save_copy(path, folder, "x", STAMP)

    assert first.name == "wall-following-20040426T100000-x.knowledge"
    assert third.name == "wall-following-20040426T100000-x-4.knowledge"
    assert first.sha256 == third.sha256 == hashlib.sha256((folder / first.name).read_bytes()).hexdigest()
    assert (folder / "wall-following-20040426T100000-x-2.knowledge").is_symlink()


def test_save_copy_full_disk_leaves_no_file(path: Path, tmp_path: Path) -> None:
    folder = tmp_path / "saved"
    size = begun(path, lessons=300).stat().st_size
    with largest_file(size - 1), refused(KnowledgeCode.FOLDER_NOT_WRITABLE):
        save_copy(path, folder, "x", STAMP)

    assert names(folder) == []


def test_save_copy_other_files_are_refused(path: Path, tmp_path: Path) -> None:
    with refused(KnowledgeCode.NOT_OPENED):
        save_copy(path, tmp_path / "saved", "x", STAMP)
    tamper(path, "CREATE TABLE bookmark (url TEXT)")
    with refused(KnowledgeCode.OTHER_PROGRAM):
        save_copy(path, tmp_path / "saved", "x", STAMP)
    path.write_text("Dear diary,\n" * 1000)
    with refused(KnowledgeCode.PAGES_DAMAGED):
        save_copy(path, tmp_path / "saved", "x", STAMP)

    assert not (tmp_path / "saved").exists()


def test_save_copy_kill_leaves_whole_copies(path: Path, tmp_path: Path) -> None:
    begun(path, lessons=500)
    folder = tmp_path / "saved"
    told = []
    for kill_after in (1, 4, 9):
        with started("tests.knowledge.copy_until_killed", str(path), str(folder), STAMP, folder=ROOT) as child:
            assert child.stdout is not None
            told += [child.stdout.readline().strip() for _ in range(kill_after)]
            child.kill()
    copies = sorted(folder.glob("*.knowledge"))
    assert {copy.name for copy in copies} >= set(told)
    contents = {copy.read_bytes() for copy in copies}
    assert len(contents) == 1
    with Journal.read_only(copies[0]) as look:
        assert len(look.events()) == 500
