"""`kurt2rt lesson --exams batch` and `--lessons batch`."""

import json

import pytest

from tests.cli.helpers import CommandLine

SHORT = ("--set", "teaching.supervised_s=5", "--set", "teaching.corrections_s=0", "--set", "exam.duration_s=2")


@pytest.mark.parametrize("driven", ["--exams", "--lessons"])
def test_lesson_has_the_same_results_in_a_batch(kurt2rt: CommandLine, driven: str) -> None:
    told = [
        json.loads(kurt2rt("lesson", *SHORT, "--seeds", "1-2", "--jobs", "1", "--json", driven, each).out)
        for each in ("batch", "bus")
    ]
    assert told[0]["robots"] == told[1]["robots"]


@pytest.mark.parametrize(
    ("words", "why"),
    [
        ((), "give --seeds"),
        (("--seeds", "1-2", "--task", "route"), "course route"),
        (("--seeds", "1-2", "--wire", "lossy"), "no wire"),
    ],
)
def test_lesson_refuses_exams_that_a_batch_does_not_know(
    kurt2rt: CommandLine, words: tuple[str, ...], why: str
) -> None:
    assert why in kurt2rt.refused("lesson", *SHORT, "--exams", "batch", *words)


@pytest.mark.parametrize(
    ("words", "why"),
    [
        ((), "give --seeds"),
        (("--seeds", "1-2", "--task", "route"), "course route"),
        (("--seeds", "1-2", "--wire", "lossy"), "no wire"),
        (("--seeds", "1-2", "--teacher", "ordinary", "--controls"), "drives by hand"),
    ],
)
def test_lesson_refuses_lessons_that_a_batch_does_not_know(
    kurt2rt: CommandLine, words: tuple[str, ...], why: str
) -> None:
    assert why in kurt2rt.refused("lesson", *SHORT, "--lessons", "batch", *words)
