"""`--teacher` on the command line."""

from pathlib import Path

import pytest

from tests.cli.helpers import CommandLine, unknown_name


@pytest.mark.parametrize("words", [("train",), ("demo",), ("study", "paper"), ("study", "phases"), ("run", "--auto")])
def test_teacher_unknown_name_is_refused_before_work(kurt2rt: CommandLine, words: tuple[str, ...]) -> None:
    said = kurt2rt.refused(*words, "--teacher", "nosuch")
    assert unknown_name("teachers", "nosuch") in said
    assert not Path("results").exists()
