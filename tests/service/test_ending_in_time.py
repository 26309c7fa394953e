"""SIGTERM brakes the wheels and ends the program, also where disk, recorder, network or the loop hang for ever."""

import os
import signal
import subprocess
import sys
import time
import uuid
from contextlib import ExitStack
from pathlib import Path

import anyio.to_thread
import can
import pytest

from kurt2rt.service.shutdown import ShutdownStage, timeout_message
from tests.cli.helpers import started
from tests.cli.three_programs import brakes, is_control, onlooker

SAYS = {
    "start": (timeout_message(ShutdownStage.DISK),),
    "disk": (
        "disk does not answer; look at its health; closed with 0 lessons not written",
        timeout_message(ShutdownStage.LESSONS),
    ),
    "recorder": ("recording: the disk does not answer; the end is missing", timeout_message(ShutdownStage.RECORDING)),
    "keys": (timeout_message(ShutdownStage.DISK),),
    "network": (timeout_message(ShutdownStage.CHANNEL),),
    "loop": (timeout_message(ShutdownStage.LOOP),),
}
"""Last words by what hangs. Of two, a busy machine has the second: its time is over before the wait for the disk is."""
RARE = {"start", "recorder", "keys", "network"}


def is_from_the_tick(frame: can.Message) -> bool:
    return is_control(frame) and not brakes(frame)


@pytest.mark.parametrize("thing", [pytest.param(each, marks=pytest.mark.deep if each in RARE else ()) for each in SAYS])
async def test_the_wheels_are_braked_and_the_program_ends(thing: str, tmp_path: Path) -> None:
    bus = f"shared:ending-{uuid.uuid4().hex[:8]}"
    words = ("run", "--bus", bus, "--port", "0", "--knowledge", "mine.knowledge", "--service")
    hanging = started("tests.service.hanging_program", thing, *words, folder=tmp_path)
    with onlooker(bus) as ear, hanging as program:
        try:
            if thing != "start":
                await ear.until(is_from_the_tick)
            if thing in ("start", "loop"):
                await ear.until(brakes)
            program.send_signal(signal.SIGTERM)
            said = "".join(await anyio.to_thread.run_sync(program.communicate))  # comes back only when it has ended
        finally:
            program.kill()
        ear.look()
    assert brakes([frame for frame in ear.frames if is_control(frame)][-1])
    assert any(each in said for each in SAYS[thing])
    assert "Traceback" not in said


@pytest.mark.deep
def test_the_program_ends_with_0_on_a_machine_that_is_too_busy(tmp_path: Path) -> None:
    words = ("run", "--port", "0", "--knowledge", "mine.knowledge")
    with ExitStack() as stack:
        for _ in range(4 * (os.cpu_count() or 1)):
            busy = stack.enter_context(subprocess.Popen([sys.executable, "-c", "while True: pass"]))
            stack.callback(busy.kill)
        for waits_s in (0.0, 1.0, 2.0, 4.0, 8.0):
            with started("kurt2rt.cli.main", *words, folder=tmp_path, fresh=True) as program:
                assert program.stdout is not None
                program.stdout.readline()
                time.sleep(waits_s)  # any moment of the start and of the drive
                program.send_signal(signal.SIGTERM)
                said = program.communicate()[0]
            assert program.returncode == 0, said
