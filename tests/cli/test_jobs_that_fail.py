"""Failures of one job among many: one line with the job and its seed."""

from pathlib import Path

import pytest

from kurt2rt.cli import main
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from tests.cli.helpers import CommandLine


def test_the_job_stands_before_what_is_wrong(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    trouble = KnowledgeError(KnowledgeCode.NOT_DURABLE, reason="the disk is full")
    group = ExceptionGroup("of a task group", [trouble])
    group.add_note("circle, seed 3")

    def command_line(_words: object) -> object:
        raise group

    monkeypatch.setattr("kurt2rt.cli.command_line.command_line", command_line)
    with pytest.raises(SystemExit, match="2"):
        main.main()
    assert capsys.readouterr().err == f"kurt2rt: circle, seed 3: {trouble}\n"


def test_a_lesson_of_many_says_whose_file_is_of_no_use(kurt2rt: CommandLine) -> None:
    made = Path("made")
    made.mkdir()
    (made / "wall_following-7.knowledge").touch()
    (made / "wall_following-7.knowledge.lock").mkdir()
    said = kurt2rt("train", "--seeds", "7", "--jobs", "1", "--out", "made")
    assert said.exit_code == 2
    assert said.err.splitlines()[-1].startswith("kurt2rt: wall_following, seed 7:")
