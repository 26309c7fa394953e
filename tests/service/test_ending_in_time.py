"""SIGTERM brakes the wheels and ends the program, also where disk, recorder, network or the loop hang for ever."""

import os
import signal
import subprocess
import sys
import uuid
from pathlib import Path

import anyio.to_thread
import can
import pytest

from config import CONFIG_DIR
from tests.cli.three_programs import brakes, is_control, onlooker

SAYS = {
    "start": "ended without a thread that waits for the disk",
    "disk": "disk does not answer; look at its health; closed with 0 lessons not written",
    "recorder": "recording: the disk does not answer; the end is missing",
    "keys": "ended without a thread that waits for the disk",
    "network": "ended without the teachers' channel",
    "loop": "ended without its loop",
}
RARE = {"start", "recorder", "keys"}


def is_from_the_tick(frame: can.Message) -> bool:
    return is_control(frame) and not brakes(frame)


def start(thing: str, folder: Path, bus: str) -> "subprocess.Popen[str]":
    words = ("run", "--robot", bus, "--port", "0", "--knowledge", "mine.knowledge", "--service")
    return subprocess.Popen(
        [sys.executable, "-m", "tests.service.hanging_program", thing, *words],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(CONFIG_DIR.parent), "PYTHONUNBUFFERED": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


@pytest.mark.parametrize("thing", [pytest.param(each, marks=pytest.mark.deep if each in RARE else ()) for each in SAYS])
async def test_the_wheels_are_braked_and_the_program_ends(thing: str, tmp_path: Path) -> None:
    bus = f"shared:ending-{uuid.uuid4().hex[:8]}"
    with onlooker(bus) as ear, start(thing, tmp_path, bus) as program:
        try:
            if thing != "start":
                await ear.until(is_from_the_tick)
            if thing in ("start", "loop"):
                await ear.until(brakes)
            program.send_signal(signal.SIGTERM)
            said, _ = await anyio.to_thread.run_sync(program.communicate)  # comes back only when it has ended
        finally:
            program.kill()
        ear.look()
    assert brakes([frame for frame in ear.frames if is_control(frame)][-1])
    assert SAYS[thing] in said
    assert "Traceback" not in said
