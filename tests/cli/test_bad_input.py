"""Input errors of users: one line, exit code 2, and no file changed."""

import errno
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
import yaml

from config import CONFIG_DIR
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from tests.cli.helpers import CommandLine, unknown_name
from tests.knowledge.reading import events_in

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


@pytest.mark.parametrize("command", EVERY_WRITER + EVERY_READER, ids=" ".join)
def test_path_without_a_knowledge_file_is_refused_and_kept(
    kurt2rt: CommandLine, tmp_path: Path, command: tuple[str, ...]
) -> None:
    letter, folder = tmp_path / "letter.txt", tmp_path / "folder"
    letter.write_text(NOT_OURS, encoding="utf-8")
    folder.mkdir()
    assert str(KnowledgeError(KnowledgeCode.NO_SQLITE_FILE, where=letter)) in kurt2rt.refused(*command, letter)
    assert str(KnowledgeError(KnowledgeCode.NOT_A_FILE, where=folder)) in kurt2rt.refused(*command, folder)
    if command in EVERY_READER:
        assert os.strerror(errno.ENOENT) in kurt2rt.refused(*command, tmp_path / "none.knowledge")
        assert set(tmp_path.iterdir()) == {letter, folder}
    else:
        assert "letter.txt" in kurt2rt.refused(*command, letter / "x.knowledge")
    assert letter.read_text(encoding="utf-8") == NOT_OURS


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


@pytest.mark.parametrize(("another_task", "why"), [(other_features, "mine.knowledge: "), (few_actions, "RLA 1 ")])
def test_misfit_knowledge_is_refused_by_exam_lesson_and_run(
    kurt2rt: CommandLine, tmp_path: Path, lessons: Path, another_task: Callable[[Path], Path], why: str
) -> None:
    mine = copied(lessons, tmp_path / "mine.knowledge")
    taught = events_in(mine)
    task = another_task(tmp_path)
    service = changed("runtime", "default", tmp_path, lambda content: content.update(task=str(task)))

    assert why in kurt2rt.refused("exam", mine, "--task", task)
    assert why in kurt2rt.refused("train", "--knowledge", mine, "--task", task)
    assert why in kurt2rt.refused("run", "--knowledge", mine, "--settings", service, "--seconds", "1")
    assert events_in(mine) == taught


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
        (("run", "--auto", "--teacher", "nosuch"), unknown_name("teachers", "nosuch")),
        (("sim", "--bus", "can7"), "bus 'can7': "),
        (("sim", "--world", "nope"), unknown_name("worlds", "nope")),
        (("sim", "--robot-settings", "nope"), unknown_name("robots", "nope")),
        (("sim", "--start", "99"), " 99"),
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
        (("sim", "--bus", "virtual:x"), "--bus"),
        (("sim", "--seconds", "inf"), "--seconds"),
        (("sim", "--start", "0"), "--start"),
        (("ros", "--namespace", "a b"), "use letters, digits and _, joined by /"),
        (("ros", "--naming", "dds"), "bridge"),
        (("ros", "--domain", "233"), "232"),
        (("run", "--auto", "--task", "route"), "kurt2rt train --task route"),
        (("run", "--service", "--teacher", "none"), "--service"),
        (("run", "--service", "--auto"), "--service"),
        (("train", "--task", "circle", "--decisions", "8"), "--decisions"),
        (("train", "--task", "circle", "--basic", "here"), "--basic"),
        (("train", "--task", "route", "--decisions", "8", "--decisions", "12"), "--seeds"),
        (("study", "paper", "--seeds", "many"), "'many'"),
        (("why", "none.mcap", "--at", "3", "--from", "2"), "--from and --to"),
        (("why", "none.mcap", "--from", "3", "--to", "2"), "--from 3"),
        (("why", "none.mcap", "--picture", "why.txt"), ".png"),
        (("why", "--live", "--at", "3"), "--live"),
        (("why", "--device", "phone"), "--device"),
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


NO_POST = "task circle: metric rounds: world A has 0 round obstacles; choose one with a single one"


@pytest.mark.parametrize(
    ("line", "why"),
    [
        ("demo --set teaching.world=nope", unknown_name("worlds", "nope")),
        ("demo --set exam.worlds=[a,nope]", unknown_name("worlds", "nope")),
        ("train --set teaching.world=nope", unknown_name("worlds", "nope")),
        ("train --seeds 1,2 --set exam.worlds=[a,nope]", unknown_name("worlds", "nope")),
        ("train --task circle --set teaching.world=a", NO_POST),
        ("train --task circle --seeds 1,2 --set exam.worlds=[one_object,a]", NO_POST),
        ("demo --task circle --set exam.worlds=[one_object,a]", NO_POST),
        ("train --engine compiled", "give --seeds"),
        ("train --task route --decisions 7", "7 decisions"),
        ("study paper --task sledging", unknown_name("tasks", "sledging")),
        ("study phases --task circle", "`phases:`"),
        ("study phases --set phases.repair_worlds=[nowhere]", unknown_name("worlds", "nowhere")),
        ("study transfer --world a", "world a"),
        ("study compare --learner deep-thought", "there is no such learner"),
        ("study search sledging", unknown_name("searches", "sledging")),
        *(
            (f"{command} --teacher nosuch", unknown_name("teachers", "nosuch"))
            for command in ("train", "demo", "study paper", "study phases")
        ),
    ],
)
def test_lesson_or_study_that_cannot_be_is_refused_before_work(kurt2rt: CommandLine, line: str, why: str) -> None:
    assert why in kurt2rt.refused(*line.split(), "--out", "made")
    assert not Path("made").exists()


def test_a_damaged_lesson_is_named_and_the_rest_is_kept(kurt2rt: CommandLine, tmp_path: Path, lessons: Path) -> None:
    mine = copied(lessons, tmp_path / "mine.knowledge")
    image = mine.read_bytes()
    assert image.count(b'"teacher":"scripted teacher"') == len(events_in(mine))
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
