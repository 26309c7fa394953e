"""Input errors of users: one line, exit code 2, and no file changed."""

import errno
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
import yaml

from config import CONFIG_DIR
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from tests.cli.helpers import CommandLine, unknown_name

NOT_OURS = "to whom it may concern\n"

EVERY_WRITER = [("train", "--knowledge"), ("run", "--seconds", "0.1", "--knowledge")]
EVERY_READER = [("exam",), *(("knowledge", name) for name in ("show", "lessons", "check", "table", "undo"))]


def changed(kind: str, name: str, folder: Path, change: Callable[[dict[str, object]], None]) -> Path:
    """Write a changed copy of a shipped settings file into a folder; return its path."""
    content = yaml.safe_load((CONFIG_DIR / kind / f"{name}.yaml").read_text(encoding="utf-8"))
    change(content)
    path = folder / f"my_{kind}.yaml"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    return path


def copied(knowledge: Path, to: Path) -> Path:
    shutil.copy(knowledge, to)
    return to


def lessons_in(knowledge: Path) -> int:
    with Journal.read_only(knowledge) as journal:
        assert journal.check() == []
        return len(journal.events())


@pytest.mark.parametrize("command", EVERY_WRITER + EVERY_READER, ids=" ".join)
def test_command_with_a_foreign_file_is_refused_and_keeps_it(
    kurt2rt: CommandLine, tmp_path: Path, command: tuple[str, ...]
) -> None:
    letter = tmp_path / "letter.txt"
    letter.write_text(NOT_OURS, encoding="utf-8")
    assert str(KnowledgeError(KnowledgeCode.NO_SQLITE_FILE, where=letter)) in kurt2rt.refused(*command, letter)
    assert letter.read_text(encoding="utf-8") == NOT_OURS


@pytest.mark.parametrize("command", EVERY_WRITER + EVERY_READER, ids=" ".join)
def test_command_with_a_folder_for_a_file_is_refused(
    kurt2rt: CommandLine, tmp_path: Path, command: tuple[str, ...]
) -> None:
    (tmp_path / "folder").mkdir()
    error = KnowledgeError(KnowledgeCode.NOT_A_FILE, where=tmp_path / "folder")
    assert str(error) in kurt2rt.refused(*command, tmp_path / "folder")


@pytest.mark.parametrize("command", EVERY_READER, ids=" ".join)
def test_reader_of_a_missing_file_is_refused_and_makes_none(
    kurt2rt: CommandLine, tmp_path: Path, command: tuple[str, ...]
) -> None:
    assert os.strerror(errno.ENOENT) in kurt2rt.refused(*command, tmp_path / "none.knowledge")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("command", EVERY_WRITER, ids=" ".join)
def test_writer_below_a_file_is_refused_and_keeps_it(
    kurt2rt: CommandLine, tmp_path: Path, command: tuple[str, ...]
) -> None:
    (tmp_path / "letter.txt").write_text(NOT_OURS, encoding="utf-8")
    assert "letter.txt" in kurt2rt.refused(*command, tmp_path / "letter.txt" / "x.knowledge")
    assert (tmp_path / "letter.txt").read_text(encoding="utf-8") == NOT_OURS


def other_features(folder: Path) -> Path:
    """Return the task with a shorter history in its situation."""
    situation = changed("situations", "basic", folder, lambda content: content.update(history_steps=500))
    return changed("tasks", "wall_following", folder, lambda content: content.update(situation=str(situation)))


def few_actions(folder: Path) -> Path:
    """Return the task with a repertoire that only stands."""

    def only_stand(content: dict[str, object]) -> None:
        content["actions"] = [{"kind": "motor", "name": "stand", "left_m_s": 0.0, "right_m_s": 0.0}]

    repertoire = changed("repertoires", "basic", folder, only_stand)
    return changed("tasks", "wall_following", folder, lambda content: content.update(repertoire=str(repertoire)))


@pytest.mark.parametrize(
    ("another_task", "why"),
    [
        (other_features, "mine.knowledge: "),
        (few_actions, "RLA 1 "),
    ],
)
def test_misfit_knowledge_is_refused_by_exam_lesson_and_run(
    kurt2rt: CommandLine, tmp_path: Path, lessons: Path, another_task: Callable[[Path], Path], why: str
) -> None:
    mine = copied(lessons, tmp_path / "mine.knowledge")
    taught = lessons_in(mine)
    task = another_task(tmp_path)
    service = changed("runtime", "default", tmp_path, lambda content: content.update(task=str(task)))

    assert why in kurt2rt.refused("exam", mine, "--task", task)
    assert why in kurt2rt.refused("train", "--knowledge", mine, "--task", task)
    assert why in kurt2rt.refused("run", "--knowledge", mine, "--settings", service, "--seconds", "1")
    assert lessons_in(mine) == taught


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (("demo", "--task", "nope"), unknown_name("tasks", "nope")),
        (("train", "--task", "nope"), unknown_name("tasks", "nope")),
        (("train", "--robot-settings", "nope"), unknown_name("robots", "nope")),
        (("demo", "--robot-settings", "nope"), unknown_name("robots", "nope")),
        (("run", "--settings", "nope"), unknown_name("runtime", "nope")),
        (("run", "--world", "nope", "--seconds", "1"), unknown_name("worlds", "nope")),
        (("train", "--task", "wal_folowing"), " wall_following?"),
        (("sim", "--world", "manhatan"), " manhattan?"),
        (("sim", "--world", "cave.png"), "cave.png: "),
        (("run", "--world", "maps/cave.PGM"), " maps/cave.yaml "),
        (("replay", "/proc/self/mem"), f"[Errno {errno.EIO}]"),
        (("run", "--bus", "can7"), "bus 'can7': "),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_option_with_an_unknown_name_is_refused(kurt2rt: CommandLine, words: tuple[str, ...], why: str) -> None:
    assert why in kurt2rt.refused(*words)


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (("run", "--bus", "can7", "--auto"), "--auto"),
        (("run", "--page", "--teacher", "none"), "--teacher"),
        (("teach", "--terminal", "--auto"), "--terminal"),
        (("run", "--seconds", "nan"), "--seconds"),
        (("run", "--seconds", "inf"), "--seconds"),
        (("run", "--seconds", "0"), "--seconds"),
        (("run", "--teacher", "stranger"), "'stranger'"),
        (("train", "--seeds", "a-b"), "'a-b'"),
        (("train", "--seeds", "5-3"), "'5-3'"),
        (("train", "--seeds", "1,5-3"), "'1,5-3'"),
        (("train", "--seeds", "1,1"), "twice"),
        (("train", "--seeds", "1-99999999999"), " 100000 "),
        (("status", ""), "folder"),
        (("train", "--seeds", "1,2", "--knowledge", "mine"), "--out"),
        (("train", "--seed", "-1"), "--seed"),
        (("knowledge", "show", "mine", "--limit", "0"), "--limit"),
        (("fly",), "'fly'"),
        (("demo", "--fast"), "--fast"),
        (("exam",), "Missing argument"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_option_with_a_senseless_value_is_misuse(kurt2rt: CommandLine, words: tuple[str, ...], why: str) -> None:
    assert why in kurt2rt.misused(*words)


@pytest.mark.parametrize("command", ["train", "demo", "exam", "run"])
def test_a_weight_for_a_feature_that_there_is_not_is_refused(
    kurt2rt: CommandLine, tmp_path: Path, lessons: Path, command: str
) -> None:
    def weigh(content: dict[str, object]) -> None:
        learning = content["learning"]
        assert isinstance(learning, dict)
        learning["weights"] = [{"weight": 2.0, "features": ["s1", "s99"]}]

    task = changed("tasks", "wall_following", tmp_path, weigh)
    service = changed("runtime", "default", tmp_path, lambda content: content.update(task=str(task)))
    words: tuple[str | Path, ...] = {
        "train": ("--task", task),
        "demo": ("--task", task),
        "exam": (lessons, "--task", task, "--world", "a"),
        "run": ("--settings", service, "--seconds", "1", "--knowledge", tmp_path / "new.knowledge"),
    }[command]
    # What shows how far it is may stand before the refusal.
    said = kurt2rt(command, *words)
    assert said.exit_code == 2, said.err
    assert "Traceback" not in said.err
    last = said.err.strip().splitlines()[-1]
    assert last.startswith("kurt2rt: task wall_following: learning.weights.0.features: ")
    assert "'s99'" in last


@pytest.mark.parametrize(
    ("where", "command"),
    [("teaching", ("demo",)), ("exam", ("demo",)), ("teaching", ("train",)), ("exam", ("train", "--seeds", "1,2"))],
)
def test_task_with_unknown_world_is_refused_before_the_lesson(
    kurt2rt: CommandLine, tmp_path: Path, where: str, command: tuple[str, ...]
) -> None:
    def somewhere_else(content: dict[str, object]) -> None:
        part = content[where]
        assert isinstance(part, dict)
        part.update({"world": "nope"} if where == "teaching" else {"worlds": ["a", "nope"]})

    task = changed("tasks", "wall_following", tmp_path, somewhere_else)
    assert unknown_name("worlds", "nope") in kurt2rt.refused(*command, "--task", task, "--out", tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_damaged_lesson_is_named_and_the_rest_is_kept(kurt2rt: CommandLine, tmp_path: Path, lessons: Path) -> None:
    mine = copied(lessons, tmp_path / "mine.knowledge")
    image = mine.read_bytes()
    assert image.count(b'"teacher":"scripted teacher"') == lessons_in(mine)
    mine.write_bytes(image.replace(b'"teacher":"scripted teacher"', b'"teacher":"scripted preacher"'[:28]))
    for command in (EVERY_WRITER[0], EVERY_WRITER[1], ("exam",)):
        assert KnowledgeCode.ROW_CHANGED.do in kurt2rt.refused(*command, mine)
    said = kurt2rt("knowledge", "check", mine)
    assert said.exit_code == 1
    assert len(said.out.splitlines()) == image.count(b'"teacher":"scripted teacher"')


@pytest.mark.parametrize("command", ["demo", "train", "run", "study compare", "study transfer"])
def test_task_of_another_robot_is_refused_with_that_robot(kurt2rt: CommandLine, command: str) -> None:
    refused = kurt2rt.refused(*command.split(), "--task", "school/fleeing", "--robot-settings", "kurt2")
    assert "task school/fleeing: is for the robot school (got the robot kurt2" in refused
    assert refused.endswith("; give --robot-settings school")
