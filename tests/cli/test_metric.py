"""A metric that a world cannot give is refused before anything is taught."""

from pathlib import Path

import pytest

from tests.cli.helpers import CommandLine

NO_POST = "task circle: metric rounds: world A has 0 round obstacles; choose one with a single one"


@pytest.mark.parametrize(
    "words",
    [
        ("train", "--set", "teaching.world=a"),
        ("train", "--seeds", "1,2", "--set", "exam.worlds=[one_object, a]"),
        ("demo", "--set", "exam.worlds=[one_object, a]"),
    ],
    ids=" ".join,
)
def test_it_is_said_in_one_line_and_nothing_is_made(kurt2rt: CommandLine, words: tuple[str, ...]) -> None:
    assert NO_POST in kurt2rt.refused(*words, "--task", "circle", "--out", "made")
    assert not Path("made").exists()
