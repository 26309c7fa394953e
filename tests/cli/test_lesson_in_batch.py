"""`kurt2rt lesson --exams batch` and `--lessons batch`."""

from pathlib import Path

import pytest

from tests.cli.helpers import CommandLine

SHORT = ("--set", "teaching.supervised_s=5", "--set", "teaching.corrections_s=0", "--set", "exam.duration_s=2")


@pytest.mark.parametrize("option", ["--exams", "--lessons"])
def test_lesson_refuses_a_batch_of_one_robot(kurt2rt: CommandLine, option: str) -> None:
    assert "give --seeds" in kurt2rt.refused("lesson", *SHORT, option, "batch")


def test_lesson_of_an_unknown_task_goes_to_the_bus_and_says_so(kurt2rt: CommandLine) -> None:
    asks = ("--set", "learning.doubt.asks=true", "--lessons", "batch", "--exams", "bus")
    told = kurt2rt("lesson", *SHORT, "--seeds", "1", "--jobs", "1", *asks)
    assert told.exit_code == 0, told.err
    assert "wall_following: lessons on the CAN bus, because a batch does not know a robot that asks" in told.err


def test_lesson_goes_on_in_no_folder_in_which_a_witness_differs(kurt2rt: CommandLine) -> None:
    words = ("lesson", *SHORT, "--seeds", "1", "--jobs", "1", "--lessons", "batch")
    assert kurt2rt(*words).exit_code == 0
    (path,) = Path("results/lesson/results/witnesses").glob("*.json")
    path.write_text(path.read_text().replace('"differing":[]', '"differing":["lesson.asks"]'))
    for loop in ("batch", "bus"):
        assert "differ in lesson.asks; all results" in kurt2rt.refused(*words[:-1], loop)
