"""`kurt2rt why`, of the stored runs."""

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

from hal.robot_settings import load_robot
from kurt2rt.channel.security.pairing import ONLOOKER, local_pairing
from kurt2rt.cli.options import seconds_of
from kurt2rt.cli.why_live import ask_why
from kurt2rt.teacher.client.answer import NoAnswer, NoAnswerError, no_robot
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
        r"^walls.mcap: .* 2026-03-20 09:46:40 UTC, 12.00 s \(tick 1201\)",
        r"RLA 3, .* \d+ of R 900 \(\d+ %\).",
        r"RLA 3 taught: \w+; tick 1\d+ of its run",
        rf" {picture}$",
    ):
        assert re.search(words, said.out, re.MULTILINE), words
    assert "RLA 3" in picture.read_text(encoding="utf-8")


def test_the_level_above_is_told_too(kurt2rt: CommandLine) -> None:
    mid = json.loads(kurt2rt("why", ERRAND, "--at", "20", "--json").out)["facts"]["mid"]["driver"]
    out = kurt2rt("why", ERRAND, "--at", "20").out
    assert out.count(mid["title"]) > 1
    assert mid["action"] in out


def test_a_whole_run_is_told_as_stretches(kurt2rt: CommandLine, tmp_path: Path) -> None:
    picture = tmp_path / "run.svg"
    said = kurt2rt("why", WALLS, "--from", "0", "--picture", picture)
    assert said.exit_code == 0, said.err
    for words in ("stands: stopped", "stands: unsaved", "session walls"):
        assert words in said.out
    assert picture.stat().st_size > 10_000


def test_without_a_time_the_last_question_is_explained(kurt2rt: CommandLine) -> None:
    said = kurt2rt("why", WALLS)
    assert said.exit_code == 0, said.err
    found = re.match(r"Most telling at (\d+\.\d\d) s: its last question\.", said.out)
    assert found is not None
    assert f" {found[1]} s (tick " in said.out


@pytest.mark.parametrize(("typed", "at_s"), [("1:30", 90.0), ("0:01:02.5", 62.5), ("90", 90.0)])
def test_a_time_is_read_as_minutes_and_seconds(typed: str, at_s: float) -> None:
    assert seconds_of(typed) == at_s


@pytest.mark.parametrize("typed", ["1:90", "soon", "-1", "1::2", "nan", "1:2:3:4"])
def test_another_form_of_a_time_is_refused(kurt2rt: CommandLine, typed: str) -> None:
    assert "1:30" in kurt2rt.misused("why", WALLS, f"--at={typed}")


def test_a_moment_behind_the_end_is_refused(kurt2rt: CommandLine, tmp_path: Path) -> None:
    slim(WALLS, short := tmp_path / "short.mcap", 2.0)
    assert " 1.99 s;" in kurt2rt.misused("why", short, "--at", "500")


def test_why_live_asks_a_running_robot_as_an_onlooker(
    kurt2rt: CommandLine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with running("run", "--port", "0", "--knowledge", "mine.knowledge", folder=tmp_path) as robot:
        port = robot.wait_for("UDP port").split()[-1]
        robot.wait_for("stands and asks")
        said = kurt2rt("why", "--live", "--port", port, "--picture", tmp_path / "now.svg")
    assert said.exit_code == 0, said.err
    assert re.search(r"^now: wall_following .* \d+", said.out)
    assert (tmp_path / "now.svg").stat().st_size > 10_000


def test_ask_why_without_a_robot_raises_no_answer(tmp_path: Path) -> None:
    device = local_pairing(tmp_path / "teachers", tmp_path / "devices", ONLOOKER).device
    with pytest.raises(NoAnswerError, match=re.escape(str(no_robot("127.0.0.1", 9, ONLOOKER)))) as refused:
        ask_why(replace(device, port=9), lambda _: load_robot(), patience_s=0.1)
    assert refused.value.code is NoAnswer.NO_ROBOT
