"""`--teacher` on the command line."""

from pathlib import Path

import pytest

from tests.cli.helpers import CommandLine, unknown_name
from tests.cli.test_paper import short_task


@pytest.mark.parametrize("words", [("train",), ("demo",), ("study", "paper"), ("study", "phases"), ("run", "--auto")])
def test_teacher_unknown_name_is_refused_before_work(kurt2rt: CommandLine, words: tuple[str, ...]) -> None:
    said = kurt2rt.refused(*words, "--teacher", "nosuch")
    assert unknown_name("teachers", "nosuch") in said
    assert not Path("results").exists()


def test_train_controls_of_a_basic_task_are_refused(kurt2rt: CommandLine, tmp_path: Path) -> None:
    assert "--baselines" in kurt2rt.misused("train", "--task", short_task(tmp_path), "--baselines", "--seeds", "1")
