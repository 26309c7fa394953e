"""A service manager kills what falls silent and starts it anew: the robot then stands until Go."""

import os
import signal
import subprocess
import sys
import uuid
from pathlib import Path

import pytest

from config import CONFIG_DIR
from tests.cli.helpers import Running
from tests.cli.three_programs import drives, onlooker
from tests.systemd.manager import Manager, manager

WATCHDOG_S = 1.0


def start(systemd: Manager, folder: Path, bus: str, *command: str) -> "subprocess.Popen[str]":
    environment = {**os.environ, "PYTHONPATH": str(CONFIG_DIR.parent), "PYTHONUNBUFFERED": "1"}
    environment |= systemd.environment(WATCHDOG_S)
    del environment["WATCHDOG_PID"]
    return subprocess.Popen(
        [sys.executable, "-m", *command, "run", "--service", "--robot", bus, "--knowledge", "mine.knowledge"],
        cwd=folder,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.mark.deep
def test_a_loop_that_hangs_is_killed_and_what_comes_after_it_stands(tmp_path: Path) -> None:
    bus = f"shared:watched-{uuid.uuid4().hex[:8]}"
    with manager(tmp_path) as systemd, onlooker(bus) as ear:
        with start(systemd, tmp_path, bus, "tests.service.hanging_program", "loop") as hangs:
            systemd.wait_for("READY=1")
            systemd.wait_for("WATCHDOG=1")
            while systemd.hears("WATCHDOG=1", within_s=WATCHDOG_S):
                pass
            hangs.send_signal(signal.SIGABRT)
            assert hangs.wait() == -signal.SIGABRT
        with start(systemd, tmp_path, bus, "kurt2rt.cli.main") as next_one:
            program = Running(next_one)
            systemd.wait_for("READY=1")
            program.wait_for("stands until Go: the robot program was started")
            while not systemd.hears("WATCHDOG=1", within_s=60.0):
                pass
            assert program.end(signal.SIGTERM).exit_code == 0
        ear.look()
        assert not any(map(drives, ear.frames))
