"""`kurt2rt study certify` as a user meets it."""

import json
from pathlib import Path

import pytest

from tests.cli.helpers import CommandLine

SHORT = ("--seconds", "1", "--runs", "3", "--jobs", "1", "--out", "made", "--pictures", "1")


def test_certificate_names_runs_that_exam_repeats(kurt2rt: CommandLine, lessons: Path) -> None:
    said = kurt2rt("study", "certify", lessons, *SHORT, "--world", "c", "--json")
    assert said.exit_code == 0, said.err
    found = json.loads(said.out)
    assert (found["task"], found["seconds"], found["compared"]) == ("wall_following", 1.0, 3)
    assert [(each["place"], each["runs"]) for each in found["places"]] == [("c", 3)]
    page = Path(found["report"]).read_text(encoding="utf-8")
    assert "--runs 3 --seconds 1 --world c --first-seed 20000" in page
    for worst in found["worst"]:
        assert Path(f"made/run-{worst['seed']}.png").is_file()
        again = json.loads(kurt2rt(*worst["command"].split()[1:], "--json").out)
        (exam,) = again["exams"]
        assert exam["learned"]["collisions"] == worst["collisions"]
        assert worst["command"] in page


ALONE = ("--set", "learning.doubt.asks=true", "--set", "learning.doubt.alone=true")
"""Settings of a robot that a batch does not know."""


def test_task_that_the_batch_does_not_know_is_driven_on_the_bus(kurt2rt: CommandLine, lessons: Path) -> None:
    said = kurt2rt("study", "certify", lessons, *SHORT, *ALONE)
    assert said.exit_code == 0, said.err
    assert "stands at a doubt without a teacher" in said.err
    assert "All runs were driven on the CAN bus" in said.out


def test_exam_repeats_a_run_with_a_broken_sensor(kurt2rt: CommandLine, lessons: Path) -> None:
    words = ("exam", lessons, "--world", "a", "--seed", "20000", "--set", "exam.duration_s=4", "--json")
    working, broken = (
        json.loads(kurt2rt(*words, *more).out)["exams"][0] for more in ((), ("--broken-sensor", "s3=unplugged"))
    )
    assert working["teacher"] == broken["teacher"]
    assert working["learned"] != broken["learned"]
    assert "s15=low" in kurt2rt.refused(*words, "--broken-sensor", "s99=low")


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (("--runs", "0"), "--runs"),
        (("--seconds", "0"), "--seconds"),
        (("--dead-sensors", "2"), "--dead-sensors"),
        (("--world", "nowhere"), "nowhere"),
        (("--task", "circle"), "circle"),
        (("--world", "two_objects", "--set", "metric.kind=rounds"), "metric"),
    ],
)
def test_bad_input_is_refused_in_one_line(
    kurt2rt: CommandLine, lessons: Path, words: tuple[str, ...], why: str
) -> None:
    assert why in kurt2rt.refused("study", "certify", lessons, *SHORT, *words)
    assert not Path("made").exists()
