"""`--teacher` on the command line."""

import json
from pathlib import Path

import pytest

from tests.cli.helpers import CommandLine, unknown_name
from tests.cli.test_paper import short_task


@pytest.mark.parametrize("words", [("lesson",), ("demo",), ("paper",), ("phases",), ("run", "--auto")])
def test_teacher_unknown_name_is_refused_before_work(kurt2rt: CommandLine, words: tuple[str, ...]) -> None:
    said = kurt2rt.refused(*words, "--teacher", "nosuch")
    assert unknown_name("teachers", "nosuch") in said
    assert not Path("results").exists()


def test_lesson_controls_compare_teachers(kurt2rt: CommandLine, tmp_path: Path) -> None:
    task = short_task(tmp_path)
    words = ("lesson", "--task", task, "--teacher", "slow", "--seeds", "1", "--jobs", "1", "--controls")
    done = kurt2rt(*words)
    assert done.exit_code == 0, done.err
    ways = ["press", "hold", "rewind, shows first", "rewind, lesson at 60% of the speed"]
    controls = [*(f"slow, {way}" for way in ways), "superhuman, press", "answers_only, nothing"]
    for label in ("slow, rewind", *controls):
        assert label in done.out
    data = json.loads(kurt2rt(*words, "--json").out)
    assert data["teacher"] == "slow"
    assert list(data["controls"]) == controls
    assert [each["lesson"]["corrections"] for each in data["controls"]["answers_only, nothing"]] == [0]


def test_lesson_controls_without_seeds_are_refused(kurt2rt: CommandLine, tmp_path: Path) -> None:
    assert "--seeds" in kurt2rt.misused("lesson", "--task", short_task(tmp_path), "--controls")
