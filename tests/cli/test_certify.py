"""`kurt2rt certify` as a user meets it."""

import json
from pathlib import Path

import pytest

from tests.cli.helpers import CommandLine

SHORT = ("--seconds", "1", "--runs", "3", "--jobs", "1", "--out", "made", "--pictures", "1")


def test_certificate_names_runs_that_exam_repeats(kurt2rt: CommandLine, lessons: Path) -> None:
    said = kurt2rt("certify", lessons, *SHORT, "--world", "c", "--json")
    assert said.exit_code == 0, said.err
    found = json.loads(said.out)
    assert (found["task"], found["seconds"], found["compared"]) == ("wall_following", 1.0, 3)
    assert [(each["place"], each["runs"]) for each in found["places"]] == [("c", 3)]
    page = Path(found["report"]).read_text(encoding="utf-8")
    assert "--first-seed 20000 --world c --set exam.duration_s=1" in page
    for worst in found["worst"]:
        assert Path(f"made/run-{worst['number']}.png").is_file()
        again = json.loads(kurt2rt(*worst["command"].split()[1:], "--json").out)
        (exam,) = again["exams"]
        assert exam["learned"]["collisions"] == worst["collisions"]
        assert worst["command"] in page


def test_certificate_is_read_again_and_printed(kurt2rt: CommandLine, lessons: Path) -> None:
    words = ("certify", lessons, *SHORT)
    assert kurt2rt(*words).exit_code == 0
    (block,) = Path("made/results").glob("runs-*.json")
    before = block.stat().st_mtime_ns
    said = kurt2rt(*words)
    assert said.exit_code == 0, said.err
    assert block.stat().st_mtime_ns == before
    assert "Probability within 1 s of wall_following" in said.out
    assert "report  made/report.html" in said.out


def test_task_that_the_batch_does_not_know_is_driven_on_the_bus(kurt2rt: CommandLine, lessons: Path) -> None:
    said = kurt2rt("certify", lessons, *SHORT, "--set", "learning.past_weight=0.5")
    assert said.exit_code == 0, said.err
    assert "All runs were driven on the CAN loop" in said.out


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
        (("--world", "two_objects", "--set", "course.kind=rounds"), "course"),
    ],
)
def test_bad_input_is_refused_in_one_line(
    kurt2rt: CommandLine, lessons: Path, words: tuple[str, ...], why: str
) -> None:
    assert why in kurt2rt.refused("certify", lessons, *SHORT, *words)
    assert not Path("made").exists()
