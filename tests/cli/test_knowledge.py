"""`kurt2rt knowledge`: looked at, put out as a table, and taken back lesson by lesson."""

import csv
import shutil
from pathlib import Path

from kurt2rt.knowledge.entry import JournalEntry
from kurt2rt.knowledge.fold import fold_journal
from kurt2rt.knowledge.journal import Journal
from kurt2rt.knowledge.writer import utc_now
from kurt2rt.rla.rla import CRITIC, ActionWithdrawn, Credit, Origin, Phase, RlaRewarded
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


def test_all_that_the_critic_did_is_listed_and_taken_back(kurt2rt: CommandLine, tmp_path: Path, lessons: Path) -> None:
    mine = Path(shutil.copy(lessons, tmp_path / "mine.knowledge"))
    before = folded(mine)
    first, second = before.rlas[:2]
    assert "holds no lesson by critic that stands" in kurt2rt.refused("knowledge", "undo", mine, "--of", "critic")
    with Journal.read_only(mine) as look:
        binding = look.binding
    with Journal.open(mine, binding) as journal:
        events = (
            RlaRewarded(first.rla_id, -1, 10, _by_critic("blame"), (Credit(first.rla_id, -0.3),), said=-1),
            ActionWithdrawn(second.rla_id, second.action, _by_critic("withdraw")),
        )
        journal.append([JournalEntry(event, utc_now()) for event in events])

    listed = kurt2rt("knowledge", "lessons", mine, "--of", "critic").out
    assert listed.index("withdrawn: it asks again") < listed.index("punished")
    assert "scripted" not in listed
    assert "asks again" in kurt2rt("knowledge", "show", mine, "--limit", "2").out
    said = kurt2rt("knowledge", "undo", mine, "--of", "critic")
    assert said.out.splitlines() == [
        f"{mine}: undone: RLA {second.rla_id} withdrawn: it asks again (lesson withdraw by critic)",
        f"{mine}: undone: RLA {first.rla_id} punished (lesson blame by critic)",
        f"{mine}: 2 lessons of critic undone",
    ]
    assert folded(mine).rlas == before.rlas
    assert kurt2rt("knowledge", "check", mine).exit_code == 0
    assert kurt2rt("knowledge", "undo", mine, "--of", "critic", "--lesson", "blame").exit_code == 2


def _by_critic(command_id: str) -> Origin:
    return Origin(command_id, CRITIC, Phase.AUTONOMOUS, tick=100)


def test_the_table_goes_where_it_is_wanted_and_never_over_another_one(
    kurt2rt: CommandLine, tmp_path: Path, lessons: Path
) -> None:
    for _ in range(2):
        said = kurt2rt("knowledge", "table", lessons, "--out", tmp_path / "tables")
        assert said.exit_code == 0
        table = Path(said.out.split()[1])
        with table.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        assert [int(row["id"]) for row in rows] == [rla.rla_id for rla in folded(lessons).rlas]
    assert len(list((tmp_path / "tables").iterdir())) == 2


def test_a_table_that_cannot_be_written_is_refused(kurt2rt: CommandLine, tmp_path: Path, lessons: Path) -> None:
    (tmp_path / "tables").write_text("in the way", encoding="utf-8")
    assert "tables: nothing can be saved there" in kurt2rt.refused(
        "knowledge", "table", lessons, "--out", tmp_path / "tables"
    )
