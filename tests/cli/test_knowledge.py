"""`kurt2rt knowledge`: looked at, put out as a table, and taken back lesson by lesson."""

import csv
import json
import shutil
from pathlib import Path

import pytest

from kurt2rt.core.rla.credit import Credit
from kurt2rt.core.rla.events import ActionReplaced, ActionWithdrawn, RlaRewarded, SessionBegun
from kurt2rt.core.rla.phase import Phase
from kurt2rt.core.rla.rla import CRITIC, Origin
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.fold import fold_journal
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.writer import utc_now
from tests.cli.helpers import CommandLine


def folded(knowledge: Path) -> RlaSystem:
    with Journal.read_only(knowledge) as journal:
        return fold_journal(journal, radius=1.0)


def test_undo_last_lesson_then_one_by_id(kurt2rt: CommandLine, tmp_path: Path, lessons: Path) -> None:
    mine = Path(shutil.copy(lessons, tmp_path / "mine.knowledge"))
    before = folded(mine)
    last = before.last_standing_lesson
    assert last is not None
    said = kurt2rt("knowledge", "undo", mine)
    assert said.exit_code == 0
    not_tried, undone = said.out.splitlines()
    assert not_tried.startswith("not tried: var/runs holds no recorded run")
    assert undone.startswith(f"{mine}: undone: RLA ")
    assert undone.endswith(f"(lesson {last} by scripted teacher)")

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


@pytest.mark.parametrize(
    "words",
    [
        *(("list",), ("show",), ("check",), ("lessons",), ("undo", "--dry-run")),
        ("undo", "--of", "scripted teacher", "--dry-run"),
    ],
    ids=" ".join,
)
def test_reading_commands_leave_no_files(
    kurt2rt: CommandLine, tmp_path: Path, lessons: Path, words: tuple[str, ...]
) -> None:
    mine = Path(shutil.copy(lessons, tmp_path / "mine.knowledge"))
    what, *options = words
    assert kurt2rt("knowledge", what, mine, *options).exit_code == 0
    assert [each.name for each in tmp_path.iterdir()] == [mine.name]
    assert mine.read_bytes() == lessons.read_bytes()


def test_undo_all_of_the_critic(kurt2rt: CommandLine, tmp_path: Path, lessons: Path) -> None:
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
    said = kurt2rt("knowledge", "undo", mine, "--of", "critic", "--no-preview")
    assert said.out.splitlines() == [
        f"{mine}: undone: RLA {second.rla_id} withdrawn: it asks again (lesson withdraw by critic)",
        f"{mine}: undone: RLA {first.rla_id} punished (lesson blame by critic)",
        f"{mine}: 2 lessons of critic undone",
    ]
    assert folded(mine).rlas == before.rlas
    assert kurt2rt("knowledge", "check", mine).exit_code == 0
    assert kurt2rt("knowledge", "undo", mine, "--of", "critic", "--lesson", "blame").exit_code == 2
    assert kurt2rt("knowledge", "redo", mine, "--of", "critic", "--lesson", "blame").exit_code == 2
    assert kurt2rt("knowledge", "redo", mine, "--of", "critic", "--no-preview").out.splitlines() == [
        f"{mine}: stands again: RLA {first.rla_id} punished (lesson blame by critic)",
        f"{mine}: stands again: RLA {second.rla_id} withdrawn: it asks again (lesson withdraw by critic)",
        f"{mine}: 2 lessons of critic stand again",
    ]


def _by_critic(command_id: str) -> Origin:
    return Origin(command_id, CRITIC, Phase.AUTONOMOUS, tick=100)


def test_table_folder_is_made_and_nothing_overwritten(kurt2rt: CommandLine, tmp_path: Path, lessons: Path) -> None:
    for _ in range(2):
        said = kurt2rt("knowledge", "table", lessons, "--out", tmp_path / "tables")
        assert said.exit_code == 0
        table = Path(said.out.split()[1])
        with table.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        assert [int(row["id"]) for row in rows] == [rla.rla_id for rla in folded(lessons).rlas]
    assert len(list((tmp_path / "tables").iterdir())) == 2


def test_table_unwritable_folder_is_refused(kurt2rt: CommandLine, tmp_path: Path, lessons: Path) -> None:
    (tmp_path / "tables").write_text("in the way", encoding="utf-8")
    assert "tables: nothing can be saved there" in kurt2rt.refused(
        "knowledge", "table", lessons, "--out", tmp_path / "tables"
    )


def test_undo_then_redo_restores_the_lesson(kurt2rt: CommandLine, tmp_path: Path, lessons: Path) -> None:
    mine = Path(shutil.copy(lessons, tmp_path / "mine.knowledge"))
    before = folded(mine)
    kurt2rt("knowledge", "undo", mine)
    assert f"\n{mine}: stands again: RLA " in kurt2rt("knowledge", "redo", mine).out
    assert folded(mine).rlas == before.rlas
    assert "holds no lesson that was undone" in kurt2rt.refused("knowledge", "redo", mine)
    assert "command line" not in kurt2rt("knowledge", "lessons", mine, "--limit", "1").out


def test_branch_is_listed_taught_compared_and_merged(kurt2rt: CommandLine, tmp_path: Path, lessons: Path) -> None:
    mine = Path(shutil.copy(lessons, tmp_path / "mine.knowledge"))
    count = len(folded(mine))
    first = folded(mine).lessons[0].event.origin.command_id
    said = kurt2rt("knowledge", "branch", mine, "early.knowledge", "--at", first)
    assert said.out == "branch  early.knowledge: the first 1 rows of mine.knowledge\n"
    assert kurt2rt("knowledge", "branch", mine, "late.knowledge").exit_code == 0
    listed = kurt2rt("knowledge", "list", tmp_path).out
    assert listed.count("mine.knowledge,") == 2
    assert "wall_following" in listed

    kurt2rt("knowledge", "undo", "late.knowledge", "--lesson", first)
    told = kurt2rt("knowledge", "diff", mine, "late.knowledge").out
    assert f"1 lessons stand only in {mine}:" in told
    assert f"1 RLAs live only in {mine}:\n  RLA 1: " in told
    as_json = json.loads(kurt2rt("knowledge", "diff", "early.knowledge", mine, "--json").out)
    assert as_json["common_rows"] == 1
    assert len(as_json["rlas_only_there"]) == count - 1

    dry = kurt2rt("knowledge", "merge", mine, "late.knowledge", "--dry-run")
    assert dry.out == f"{mine}: brought in: 1 undone (nothing was changed: --dry-run)\n"
    assert kurt2rt("knowledge", "merge", mine, "late.knowledge").exit_code == 0
    assert folded(mine).get(1) is None
    assert "nothing is there that is not here" in kurt2rt("knowledge", "merge", mine, "late.knowledge").out
    assert "know the same" in kurt2rt("knowledge", "diff", mine, "late.knowledge").out


def test_branch_clock_set_back_is_reported(kurt2rt: CommandLine, tmp_path: Path, lessons: Path) -> None:
    mine = Path(shutil.copy(lessons, tmp_path / "mine.knowledge"))
    with Journal.read_only(mine) as look:
        binding, entries = look.binding, look.entries()
    newest = entries[-1].stamped_at
    with Journal.open(mine, binding) as journal:
        for number, stamp in enumerate(("2099-01-01T00:00:00.000+00:00", newest)):
            begun = SessionBegun("evening", Origin(f"late-{number}", "Ann", Phase.CORRECTIONS, 9))
            journal.append([JournalEntry(begun, stamp)])
    said = kurt2rt("knowledge", "branch", mine, "then.knowledge", "--at", newest).out
    assert f"the first {len(entries)} rows of mine.knowledge\n1 later rows bear dates before that, too" in said


def test_merge_conflict_is_settled_by_prefer(kurt2rt: CommandLine, tmp_path: Path, lessons: Path) -> None:
    mine = Path(shutil.copy(lessons, tmp_path / "mine.knowledge"))
    kurt2rt("knowledge", "branch", mine, "other.knowledge")
    for path, action in ((mine, "left"), (tmp_path / "other.knowledge", "right")):
        with Journal.read_only(path) as look:
            binding = look.binding
        with Journal.open(path, binding) as journal:
            correction = ActionReplaced(1, action, "forward", Origin(f"by-{action}", "Ann", Phase.CORRECTIONS, 9))
            journal.append([JournalEntry(correction, utc_now())])
    said = kurt2rt("knowledge", "merge", mine, "other.knowledge")
    assert said.exit_code == 1
    assert said.out.splitlines() == [
        "conflict  here RLA 1 says left, there RLA 1 says right: changed on both sides",
        f"{mine}: nothing was changed; say --prefer mine or --prefer theirs",
    ]
    assert kurt2rt("knowledge", "merge", mine, "other.knowledge", "--prefer", "theirs").exit_code == 0
    rla = folded(mine).get(1)
    assert rla is not None
    assert rla.action == "right"


def test_list_empty_folder_is_empty(kurt2rt: CommandLine, tmp_path: Path) -> None:
    assert "holds no knowledge file" in kurt2rt("knowledge", "list", tmp_path).out
    (tmp_path / "broken.knowledge").write_text("nonsense", encoding="utf-8")
    assert "cannot be read" in " ".join(kurt2rt("knowledge", "list", tmp_path).out.split())


def test_list_one_file_or_missing_folder(kurt2rt: CommandLine, tmp_path: Path, lessons: Path) -> None:
    mine = Path(shutil.copy(lessons, tmp_path / "mine.db"))
    listed = " ".join(kurt2rt("knowledge", "list", mine).out.split())
    assert f"wall_following {len(folded(mine))} " in listed
    assert "nowhere: is not there" in kurt2rt.refused("knowledge", "list", tmp_path / "nowhere")
    (tmp_path / "nonsense").write_text("nonsense", encoding="utf-8")
    assert "nonsense: is not a knowledge file" in kurt2rt.refused("knowledge", "list", tmp_path / "nonsense")


def test_export_signed_is_imported(kurt2rt: CommandLine, lessons: Path) -> None:
    made = kurt2rt("knowledge", "key", "ann").out
    print_of = made.splitlines()[1].rpartition(" ")[2]
    given = kurt2rt("knowledge", "export", lessons, "out.zip", "--sign", "ann")
    assert f", signed by {print_of}\n" in given.out
    taken = kurt2rt("knowledge", "import", "out.zip", "--into", "theirs.knowledge", "--trusted", "ann.pub")
    assert taken.out.splitlines()[0].endswith(f" rows of wall_following, signed by {print_of}")
    assert folded(Path("theirs.knowledge")).rlas == folded(lessons).rlas
    unknown = kurt2rt("knowledge", "import", "out.zip", "--into", "again.knowledge").out
    assert "not checked (--trusted)" in unknown
    Path("torn.zip").write_bytes(Path("out.zip").read_bytes()[:-500])
    assert "torn.zip: is torn or changed" in kurt2rt.refused("knowledge", "import", "torn.zip", "--into", "k")
