"""Failures of one job among many: one line with the job and its seed."""

import pytest

from kurt2rt.cli import main
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError


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
