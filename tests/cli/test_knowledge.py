"""`kurt2rt knowledge`: looked at, put out as a table, and taken back lesson by lesson."""

import json
import re
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from kurt2rt.core.rla.credit import Credit
from kurt2rt.core.rla.events import ActionReplaced, ActionWithdrawn, RlaCreated, RlaRewarded
from kurt2rt.core.rla.rla import CRITIC, Origin, Phase, Rla
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from tests.cli.helpers import CommandLine
from tests.knowledge.lessons import teach
from tests.knowledge.reading import folded


@pytest.mark.parametrize(
    "words",
    [
        *(("list",), ("show",), ("check",), ("lessons",), ("undo", "--dry-run")),
        ("undo", "--teacher", "scripted teacher", "--dry-run"),
    ],
    ids=" ".join,
)
def test_reading_commands_leave_no_files(
    kurt2rt: CommandLine, tmp_path: Path, lessons: Path, mine: Path, words: tuple[str, ...]
) -> None:
    what, *options = words
    assert kurt2rt("knowledge", what, mine, *options).exit_code == 0
    assert [each.name for each in tmp_path.iterdir()] == [mine.name]
    assert mine.read_bytes() == lessons.read_bytes()


def test_undo_all_of_the_critic(kurt2rt: CommandLine, mine: Path) -> None:
    before = folded(mine)
    first, second = before.rlas[:2]
    assert " critic " in kurt2rt.refused("knowledge", "undo", mine, "--teacher", "critic")
    teach(
        mine,
        RlaRewarded(first.rla_id, -1, 10, _by_critic("blame"), (Credit(first.rla_id, -0.3),), said=-1),
        ActionWithdrawn(second.rla_id, second.action, _by_critic("withdraw")),
    )

    listed = kurt2rt("knowledge", "lessons", mine, "--teacher", "critic").out
    assert listed.index("withdrawn") < listed.index("punished")
    assert "scripted" not in listed
    assert "asks again" in kurt2rt("knowledge", "show", mine, "--limit", "2").out
    said = kurt2rt("knowledge", "undo", mine, "--teacher", "critic", "--no-preview")
    withdrawn, blamed = f"RLA {second.rla_id}, withdraw", f"RLA {first.rla_id}, blame"
    assert named_in(said.out) == [withdrawn, blamed]
    assert folded(mine).rlas == before.rlas
    assert kurt2rt("knowledge", "check", mine).exit_code == 0
    assert kurt2rt("knowledge", "undo", mine, "--teacher", "critic", "--lesson", "blame").exit_code == 2
    assert kurt2rt("knowledge", "redo", mine, "--teacher", "critic", "--lesson", "blame").exit_code == 2
    assert named_in(kurt2rt("knowledge", "redo", mine, "--teacher", "critic", "--no-preview").out) == [
        blamed,
        withdrawn,
    ]


def named_in(out: str) -> list[str]:
    """Return RLA and id of the lessons that lines name."""
    return [f"{rla}, {lesson}" for rla, lesson in re.findall(r"(RLA \d+).*\(lesson (\w+) by critic\)", out)]


def _by_critic(command_id: str) -> Origin:
    return Origin(command_id, CRITIC, Phase.AUTONOMOUS, tick=100)


def test_table_unwritable_folder_is_refused(kurt2rt: CommandLine, tmp_path: Path, lessons: Path) -> None:
    (tmp_path / "tables").write_text("in the way", encoding="utf-8")
    assert f"{tmp_path / 'tables'}: " in kurt2rt.refused("knowledge", "table", lessons, "--out", tmp_path / "tables")


def test_undo_then_redo_restores_the_lesson(kurt2rt: CommandLine, mine: Path) -> None:
    before = folded(mine)
    kurt2rt("knowledge", "undo", mine)
    assert f"(lesson {before.history.last_standing} " in kurt2rt("knowledge", "redo", mine).out
    assert folded(mine).rlas == before.rlas
    assert str(mine) in kurt2rt.refused("knowledge", "redo", mine)
    assert "command line" not in kurt2rt("knowledge", "lessons", mine, "--limit", "1").out


def test_copy_is_taught_and_merged(kurt2rt: CommandLine, tmp_path: Path, lessons: Path, mine: Path) -> None:
    other = Path(shutil.copy(lessons, tmp_path / "other.knowledge"))
    by_ann = replace(folded(mine).rlas[0], rla_id=1000, origin=Origin("new", "Ann", Phase.CORRECTIONS, 9))
    teach(other, RlaCreated(by_ann), _correction("right"))
    teach(mine, _correction("left"))
    before, whole = folded(mine).rlas, mine.read_bytes()
    left_out, would, nothing = kurt2rt("knowledge", "merge", mine, other, "--dry-run").out.splitlines()
    assert "RLA 1 corrected: right" in left_out
    assert " 1 lessons, 1 RLAs " in would
    assert "--dry-run" in nothing
    assert mine.read_bytes() == whole
    undo = kurt2rt("knowledge", "merge", mine, other).out.splitlines()[-1].partition("kurt2rt ")[2].split()
    assert len(folded(mine).rlas) == len(before) + 1
    assert kurt2rt("knowledge", "merge", mine, other).out.splitlines()[1:] == [
        f"{mine}: nothing is there that is not here"
    ]
    assert kurt2rt(*undo, "--no-preview").exit_code == 0
    assert folded(mine).rlas == before
    assert "1 of its lessons were undone" in kurt2rt("knowledge", "merge", mine, other).out


def _correction(action: str) -> ActionReplaced:
    return ActionReplaced(1, action, "forward", Origin(f"by-{action}", "Ann", Phase.CORRECTIONS, 9))


def test_list_empty_folder_is_empty(kurt2rt: CommandLine, tmp_path: Path) -> None:
    assert json.loads(kurt2rt("knowledge", "list", tmp_path, "--json").out)["files"] == []
    (tmp_path / "broken.knowledge").write_text("nonsense", encoding="utf-8")
    (broken,) = json.loads(kurt2rt("knowledge", "list", tmp_path, "--json").out)["unreadable"]
    assert broken["file"].endswith("broken.knowledge")


def test_list_one_file_or_missing_folder(kurt2rt: CommandLine, tmp_path: Path, lessons: Path) -> None:
    mine = Path(shutil.copy(lessons, tmp_path / "mine.db"))
    listed = " ".join(kurt2rt("knowledge", "list", mine).out.split())
    assert f"wall_following {len(folded(mine))} " in listed
    assert f"{tmp_path / 'nowhere'}: " in kurt2rt.refused("knowledge", "list", tmp_path / "nowhere")
    nonsense = tmp_path / "nonsense"
    nonsense.write_text("nonsense", encoding="utf-8")
    error = KnowledgeError(KnowledgeCode.NO_SQLITE_FILE, where=nonsense)
    assert str(error) in kurt2rt.refused("knowledge", "list", nonsense)


def test_export_is_imported(kurt2rt: CommandLine, lessons: Path) -> None:
    assert kurt2rt("knowledge", "export", lessons, "--out", "out.zip").out.startswith("export  out.zip: ")
    taken = kurt2rt("knowledge", "import", "out.zip", "--out", "theirs.knowledge")
    assert taken.out.startswith("import  theirs.knowledge: ")
    assert folded(Path("theirs.knowledge")).rlas == folded(lessons).rlas
    Path("torn.zip").write_bytes(Path("out.zip").read_bytes()[:-500])
    assert "torn.zip: " in kurt2rt.refused("knowledge", "import", "torn.zip", "--out", "k")


def test_contradictions_name_the_odd_lesson(kurt2rt: CommandLine, mine: Path) -> None:
    condition = folded(mine).rlas[0].condition
    for n, action in enumerate(("forward",) * 5 + ("whirl_left",), 1):
        origin = Origin(f"near-{n}", "Ann", Phase.SUPERVISED, n)
        teach(mine, RlaCreated(Rla(1000 + n, (condition[0] + 5000.0 + n, *condition[1:]), action, None, origin)))
    shown = kurt2rt("knowledge", "contradictions", mine)
    assert shown.exit_code == 0
    odd, total = shown.out.splitlines()
    assert all(word in odd for word in ("RLA 1006", "whirl_left", "near-6", "Ann", "forward", "RLA 1005"))
    assert total.startswith(f"{mine}: 1 of ")
    (listed,) = json.loads(kurt2rt("knowledge", "contradictions", mine, "--json").out)["contradictions"]
    assert (listed["lesson"], listed["neighbours"][0]) == ("near-6", {"rla": 1005, "action": "forward"})
    kurt2rt("knowledge", "undo", mine, "--lesson", "near-6")
    assert kurt2rt("knowledge", "contradictions", mine).out.startswith(f"{mine}: 0 of ")
