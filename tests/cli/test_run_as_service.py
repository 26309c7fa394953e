"""`kurt2rt run --service`, with a service manager that hears it."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
import yaml

from config import CONFIG_DIR
from tests.cli.helpers import CommandLine, Running
from tests.systemd.manager import Manager, manager


@pytest.fixture
def systemd(tmp_path: Path) -> Iterator[Manager]:
    with manager(tmp_path) as opened:
        yield opened


def settings_in(folder: Path, **changes: object) -> str:
    settings = yaml.safe_load((CONFIG_DIR / "runtime" / "default.yaml").read_text(encoding="utf-8"))
    path = folder / "mine.yaml"
    path.write_text(yaml.safe_dump({**settings, "port": 0, **changes}), encoding="utf-8")
    return str(path)


def test_a_day_of_the_unit(tmp_path: Path, systemd: Manager) -> None:
    environment = {**os.environ, "PYTHONUNBUFFERED": "1", **systemd.environment(0.5)}
    del environment["WATCHDOG_PID"]
    words = ("run", "--service", "--robot", "sim", "--settings", settings_in(tmp_path))
    with ExitStack() as around:
        process = subprocess.Popen(
            [sys.executable, "-m", "kurt2rt.cli.main", *words],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            cwd=tmp_path,
            env=environment,
        )
        around.enter_context(process)
        around.callback(process.kill)
        program = Running(process)
        assert systemd.wait_for("READY=1")[0] == "READY=1"
        program.wait_for("teachers are listened to on UDP port")
        program.wait_for("stands until Go: the robot program was started")
        assert systemd.wait_for("stands until Go")[-1].startswith("STATUS=")
        systemd.wait_for("WATCHDOG=1")

        settings_in(tmp_path, status_period_s=2.0, task="circle")
        process.send_signal(signal.SIGHUP)
        program.wait_for("settings taken: status_period_s")
        program.wait_for("settings for the next start, not for a robot that runs: task")
        systemd.wait_for("RELOADING=1")
        systemd.wait_for("READY=1")

        said = program.end(signal.SIGTERM)
        assert (said.exit_code, said.err) == (0, "")
        systemd.wait_for("STOPPING=1")
        assert not set(said.out) & {"\r", "\x1b", "\b"}
        assert sum("missed" in line for line in said.out.splitlines()) == 0


def test_a_terminal_that_hangs_up_ends_a_program_that_was_run_by_hand(tmp_path: Path) -> None:
    words = ("run", "--port", "0", "--knowledge", "mine.knowledge")
    with ExitStack() as around:
        process = subprocess.Popen(
            [sys.executable, "-m", "kurt2rt.cli.main", *words],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            cwd=tmp_path,
        )
        around.enter_context(process)
        around.callback(process.kill)
        program = Running(process)
        program.wait_for("teachers are listened to")
        assert program.end(signal.SIGHUP).exit_code == 0


@pytest.mark.parametrize("words", [("--teacher", "none"), ("--auto",)])
def test_a_unit_has_a_person_to_say_go(kurt2rt: CommandLine, words: tuple[str, ...]) -> None:
    assert "a person who says Go" in kurt2rt.misused("run", "--service", *words)
