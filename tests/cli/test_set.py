"""`--set KEY=VALUE`: another value for one key of the task's file, for one command."""

import re
from pathlib import Path

import pytest

from tests.cli.helpers import CommandLine

SHORT = ("--set", "teaching.supervised_s=2", "--set", "teaching.corrections_s=1")
BRIEF = ("--set", "exam.duration_s=2", "--set", "exam.worlds=[b]")
KNOWLEDGE = Path("made/wall_following-1.knowledge")


def test_set_applies_to_lesson_and_exam(kurt2rt: CommandLine) -> None:
    taught = kurt2rt("train", *SHORT, "--out", "made")
    assert taught.exit_code == 0, taught.err
    assert re.search(r"^teaching, .* +3 ", taught.out, re.MULTILINE)
    examined = kurt2rt("exam", KNOWLEDGE, *BRIEF)
    assert examined.exit_code == 0, examined.err
    assert ", 2 s " in examined.out
    assert re.findall(r"^([A-Z])  ", examined.out, re.MULTILINE) == ["B"]
    both = kurt2rt("demo", *SHORT, *BRIEF, "--out", "made")
    assert both.exit_code == 0, both.err
    assert re.search(r"^teaching, .* +3 ", both.out, re.MULTILINE)
    assert ", 2 s " in both.out


@pytest.mark.parametrize(
    "command", [("train",), ("exam", KNOWLEDGE, "--task", "wall_following"), ("demo",)], ids=lambda words: words[0]
)
def test_set_with_unknown_key_or_without_value_is_refused(
    kurt2rt: CommandLine, command: tuple[str | Path, ...]
) -> None:
    assert "wall_following.yaml: learning.radios: " in kurt2rt.refused(*command, "--set", "learning.radios=3")
    assert "'learning.radius'" in kurt2rt.misused(*command, "--set", "learning.radius")
    assert not Path("made").exists()
