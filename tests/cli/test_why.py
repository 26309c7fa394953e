"""`kurt2rt why`, of the stored runs."""

import re
from pathlib import Path

import pytest

from hal.robot_settings import load_robot
from kurt2rt.channel.security.pairing import ONLOOKER, local_pairing
from kurt2rt.cli.why_live import ask_why
from kurt2rt.teacher.client.answer import NoAnswerError
from tests.cli.helpers import CommandLine, running
from tests.runs.replay.stored_runs import STORED
from tests.runs.replay.stories import slim

WALLS = STORED / "walls.mcap"
ERRAND = STORED / "errand.mcap"


def test_a_moment_is_explained_and_drawn(kurt2rt: CommandLine, tmp_path: Path) -> None:
    picture = tmp_path / "pictures" / "why.svg"
    said = kurt2rt("why", WALLS, "--at", "12", "--picture", picture)
    assert said.exit_code == 0, said.err
    for words in (
        r"walls.mcap: wall_following on kurt2-indoor, begun 2026-03-20 09:46:40 UTC, 12.00 s \(tick 1201\)",
        r"This is like RLA 3, which says (\w+): distance \d+ of R 900 \(\d+ %\).",
        r"The runner-up of 3 is RLA \d \(\w+\) at \d+; the border to it is \d+ away",
        r"RLA 3 taught: \w+; 2026-03-20 09:46:5\d UTC \(tick 1\d+\), by scripted teacher in phase 2",
        r"Used once since",
        r"What would have changed it, one reading alone:",
    ):
        assert re.search(words, said.out), words
    assert f"picture  {picture}" in said.out
    assert "decides otherwise" not in said.out
    assert "As taught: RLA 3" in picture.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("at", "said"),
    [
        ("3", "The robot was stopped: the robot program was started. It waits for Go."),
        ("6.5", "Nothing was taught yet, so the robot asks."),
        ("14.2", "Lessons cannot be saved at the moment (the disk is full): the robot stands until they can."),
        pytest.param("28.3", "scripted teacher drives: curve_left. No RLA was asked.", marks=pytest.mark.deep),
        pytest.param("36", "whose action was withdrawn: there the robot asks.", marks=pytest.mark.deep),
    ],
)
def test_a_robot_that_stood_or_was_led_says_why(kurt2rt: CommandLine, at: str, said: str) -> None:
    assert said in kurt2rt("why", WALLS, "--at", at).out


def test_the_level_above_is_told_too(kurt2rt: CommandLine) -> None:
    out = kurt2rt("why", ERRAND, "--at", "20").out
    found = re.search(r"Mid level: (mid-level RLA \d+) commands (\w+), at", out)
    assert found is not None
    assert f"{found[1]} taught: {found[2]}" in out


def test_a_whole_run_is_told_as_stretches(kurt2rt: CommandLine, tmp_path: Path) -> None:
    picture = tmp_path / "run.svg"
    said = kurt2rt("why", WALLS, "--picture", picture)
    assert said.exit_code == 0, said.err
    for words in ("stands: stopped", "stands: unsaved", "led: by hand", "session walls begun by scripted teacher"):
        assert words in said.out
    assert re.search(r"taken back: RLA \d+ taught: \w+ \(scripted teacher\)", said.out)
    assert "stands and asks" in picture.read_text(encoding="utf-8")


def test_a_part_of_a_run_is_told_whole(kurt2rt: CommandLine) -> None:
    out = kurt2rt("why", WALLS, "--from", "30", "--to", "33").out
    assert out.startswith("walls.mcap: wall_following on kurt2-indoor")
    assert "3.0 s: drove by its RLAs 100 %" in out
    assert "RLA 1 withdrawn: it asks again (scripted teacher)" in out


def test_a_moment_behind_the_end_is_refused(kurt2rt: CommandLine, tmp_path: Path) -> None:
    slim(WALLS, short := tmp_path / "short.mcap", 2.0)
    assert "the run ends at" in kurt2rt.misused("why", short, "--at", "500")


def test_why_with_contradictory_options_is_refused_unread(kurt2rt: CommandLine, tmp_path: Path) -> None:
    for words, said in (
        (("--at", "3", "--from", "2"), "give a moment, or a part of the run"),
        (("--from", "3", "--to", "2"), "2 is not after --from 3"),
        (("--picture", "why.txt"), "give a file that ends with .png"),
    ):
        assert said in kurt2rt.misused("why", tmp_path / "none.mcap", *words)


def test_why_without_a_recorded_run_is_refused(kurt2rt: CommandLine, tmp_path: Path) -> None:
    assert "no recorded run" in kurt2rt.refused("why", "--runs", tmp_path)


def test_why_live_asks_a_running_robot_as_an_onlooker(
    kurt2rt: CommandLine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with running("run", "--port", "0", "--knowledge", "mine.knowledge", folder=tmp_path) as robot:
        port = robot.wait_for("UDP port").split()[-1]
        robot.wait_for("stands and asks")
        said = kurt2rt("why", "--live", "--port", port, "--picture", tmp_path / "now.svg")
    assert said.exit_code == 0, said.err
    assert "now: wall_following on kurt2-indoor, tick " in said.out
    assert "Nothing was taught yet, so the robot asks." in said.out
    assert "stands and asks" in (tmp_path / "now.svg").read_text(encoding="utf-8")


def test_ask_why_without_a_robot_raises_no_answer(tmp_path: Path) -> None:
    device = local_pairing(tmp_path / "teachers", tmp_path / "devices", ONLOOKER).device
    with pytest.raises(NoAnswerError, match=r"no robot answers at 127\.0\.0\.1:9 as onlooker; start one"):
        ask_why(device, "127.0.0.1", 9, load_robot(), patience_s=0.1)


def test_now_is_no_moment_of_a_run(kurt2rt: CommandLine) -> None:
    assert "is of now" in kurt2rt.misused("why", "--live", "--at", "3")
    assert "give --live" in kurt2rt.misused("why", "--as", "phone")
