"""Commands that need a robot that is not there say so in one line, and which command starts it."""

import os
import signal
from functools import partial
from pathlib import Path

import pytest

from kurt2rt.core.rla.rla import AUTO
from kurt2rt.teacher import TeacherClient
from kurt2rt.teacher.client.answer import no_robot
from tests.cli.helpers import CommandLine, running
from tests.teacher.page.test_teach_command import free_udp_port


def test_teach_auto_without_a_robot_names_what_starts_one(
    kurt2rt: CommandLine, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("kurt2rt.cli.teach.TeacherClient", partial(TeacherClient, patience_s=0.2))
    port = free_udp_port()
    line = kurt2rt.refused("teach", "--auto", "--port", str(port))
    assert line.endswith(f": {no_robot('127.0.0.1', port, AUTO)}")


def test_run_without_a_simulator_waits_and_names_its_command(tmp_path: Path) -> None:
    bus = f"shared:no-simulator-{os.getpid()}"
    words = ("run", "--bus", bus, "--port", "0", "--no-record")
    with running(*words, folder=tmp_path) as robot:
        line = robot.wait_for(f"no simulator on {bus}; ")
        assert f"kurt2rt sim --bus {bus}" in line
        with running("sim", "--bus", bus, folder=tmp_path):
            while "no simulator" in line:
                line = robot.wait_for("RLAs |")
        assert robot.end(signal.SIGINT).err == ""
