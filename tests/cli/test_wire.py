"""`--wire`: the simulated robot's bus as a wire, for every command that simulates."""

from pathlib import Path

import can
import pytest

from hal.bus import CONTROL_ID
from hal.codec import load_codec
from tests.cli.helpers import CommandLine, unknown_name

ENCODER_ID = load_codec().message("ENCODER").frame_id


@pytest.mark.parametrize("command", ["run", "lesson", "demo", "exam"])
def test_an_unknown_wire_is_refused_before_anything_is_made(
    kurt2rt: CommandLine, lessons: Path, tmp_path: Path, command: str
) -> None:
    words = (command, lessons) if command == "exam" else (command,)
    line = kurt2rt.refused(*words, "--wire", "copper")
    assert unknown_name("wires", "copper") in line
    assert [path for path in tmp_path.rglob("*") if path.is_file() and "teachers" not in str(path)] == []


def test_a_robot_on_a_bus_has_a_wire_of_its_own(kurt2rt: CommandLine) -> None:
    said = kurt2rt.misused("run", "--bus", "can0", "--wire", "lossy")
    assert "--wire: " in said


def test_a_robot_runs_over_a_wire_in_real_time(kurt2rt: CommandLine, tmp_path: Path) -> None:
    words = ("run", "--seconds", "0.4", "--teacher", "none", "--knowledge", "mine.knowledge", "--can-log", "drive.log")
    said = kurt2rt(*words, "--wire", "one_megabit")
    assert (said.exit_code, said.err) == (0, "")
    with can.LogReader(tmp_path / "drive.log") as reader:
        frames = list(reader)
    # One of each is enough: a machine that stalls for most of this time leaves few.
    assert any(frame.arbitration_id == CONTROL_ID and not frame.is_rx for frame in frames)
    assert any(frame.arbitration_id == ENCODER_ID and frame.is_rx for frame in frames)
