"""`kurt2rt knowledge`: looked at, put out as a table, and taken back lesson by lesson."""

import csv
import shutil
from pathlib import Path

from kurt2rt.knowledge.fold import fold_journal
from kurt2rt.knowledge.journal import Journal
from kurt2rt.rla.rla_system import RlaSystem
from tests.cli.helpers import CommandLine


def folded(knowledge: Path) -> RlaSystem:
    with Journal.read_only(knowledge) as journal:
        return fold_journal(journal, radius=1.0)


def test_the_last_lesson_is_undone_and_then_another_one_by_its_id(
    kurt2rt: CommandLine, tmp_path: Path, lessons: Path
) -> None:
    mine = Path(shutil.copy(lessons, tmp_path / "mine.knowledge"))
    before = folded(mine)
    last = before.last_standing_lesson
    assert last is not None
    said = kurt2rt("knowledge", "undo", mine)
    assert said.exit_code == 0
    assert said.out.startswith(f"{mine}: undone: RLA ")
    assert f"(lesson {last} by scripted teacher)" in said.out

    first = before.lessons[0].event.origin.command_id
    assert (
        f"undone: RLA 1 taught: {before.rlas[0].action} (lesson {first}"
        in kurt2rt("knowledge", "undo", mine, "--lesson", first).out
    )
    assert "was undone already; kurt2rt knowledge lessons" in kurt2rt.refused(
        "knowledge", "undo", mine, "--lesson", first
    )
    after = folded(mine)
    assert after.get(1) is None
    assert after.standing_lessons == before.standing_lessons - 2
    assert kurt2rt("knowledge", "check", mine).out == f"{mine}: every lesson can be read and fits\n"
    assert ", 2 undone by command line) by scripted" in " ".join(kurt2rt("knowledge", "show", mine).out.split())
    assert kurt2rt("knowledge", "lessons", mine, "--limit", "1").out.count("command line") == 1


def test_the_table_goes_where_it_is_wanted_and_never_over_another_one(
    kurt2rt: CommandLine, tmp_path: Path, lessons: Path
) -> None:
    for _ in range(2):
        said = kurt2rt("knowledge", "export", lessons, "--out", tmp_path / "tables")
        assert said.exit_code == 0
        table = Path(said.out.split()[1])
        with table.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        assert [int(row["id"]) for row in rows] == [rla.rla_id for rla in folded(lessons).rlas]
    assert len(list((tmp_path / "tables").iterdir())) == 2


def test_a_table_that_cannot_be_written_is_refused(kurt2rt: CommandLine, tmp_path: Path, lessons: Path) -> None:
    (tmp_path / "tables").write_text("in the way", encoding="utf-8")
    assert "tables: nothing can be saved there" in kurt2rt.refused(
        "knowledge", "export", lessons, "--out", tmp_path / "tables"
    )
