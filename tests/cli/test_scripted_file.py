"""`--auto` teaches into a file of its own, never unasked into that of a person."""

from pathlib import Path

import pytest

from hal.robot_settings import load_robot
from kurt2rt.cli.scripted_file import people_agree
from kurt2rt.core.rla.events import SessionBegun
from kurt2rt.core.rla.rla import AUTO, Origin, Phase
from kurt2rt.core.task_settings import load_task
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.loading import open_knowledge, read_teachers
from kurt2rt.knowledge.journal.writer import utc_now
from tests.cli.helpers import CommandLine

INSTEAD = "give another"


def taught_by(path: Path, *teachers: str) -> Path:
    with open_knowledge(path, load_robot("kurt2"), load_task("wall_following")) as journal:
        events = [
            SessionBegun("monday", Origin(f"c{number}", teacher, Phase.SUPERVISED, number))
            for number, teacher in enumerate(teachers)
        ]
        journal.append([JournalEntry(event, utc_now()) for event in events])
    return path


def test_run_auto_leaves_the_usual_file_alone(kurt2rt: CommandLine, tmp_path: Path) -> None:
    said = kurt2rt("run", "--auto", "--seconds", "0.1", "--port", "0", "--no-record")
    assert said.exit_code == 0, said.err
    assert "knowledge var/wall_following.auto.knowledge" in said.out
    assert not (tmp_path / "var" / "wall_following.knowledge").exists()


@pytest.mark.parametrize(
    "words", [("run", "--seconds", "0.1", "--teacher", "none", "--no-record"), ("pair", "phone")], ids=" ".join
)
def test_var_is_made_for_this_user_alone(kurt2rt: CommandLine, tmp_path: Path, words: tuple[str, ...]) -> None:
    assert kurt2rt(*words).exit_code == 0
    assert (tmp_path / "var").stat().st_mode & 0o777 == 0o700


def test_run_auto_on_a_persons_file_without_terminal_is_refused(kurt2rt: CommandLine, tmp_path: Path) -> None:
    mine = taught_by(tmp_path / "mine.knowledge", AUTO, "anna", "local", "anna")
    before = mine.read_bytes()
    line = kurt2rt.refused("run", "--auto", "--seconds", "0.1", "--port", "0", "--knowledge", "mine.knowledge")
    assert "mine.knowledge: anna and local " in line
    assert "--knowledge" in line
    assert mine.read_bytes() == before


def test_people_are_those_who_are_no_program(tmp_path: Path) -> None:
    file = taught_by(tmp_path / "a.knowledge", "critic", "scripted teacher", AUTO)
    assert read_teachers(file) == ()
    assert people_agree(str(file), read_teachers(file), INSTEAD)


@pytest.mark.parametrize("answer", [True, False])
def test_a_person_at_a_terminal_is_asked(monkeypatch: pytest.MonkeyPatch, *, answer: bool) -> None:
    asked: list[str] = []

    class Keyboard:
        def isatty(self) -> bool:
            return True

    def confirm(question: str, **_: object) -> bool:
        asked.append(question)
        return answer

    monkeypatch.setattr("sys.stdin", Keyboard())
    monkeypatch.setattr("typer.confirm", confirm)
    assert people_agree("mine.knowledge", ["anna"], INSTEAD) is answer
    (question,) = asked
    assert question.startswith("mine.knowledge: anna ")
