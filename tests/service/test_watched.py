"""Watchdog of the service manager: it restarts a silent program, and the robot stands until Go."""

import math
import signal
import subprocess
import uuid
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import anyio
import anyio.to_thread
import pytest

from kurt2rt.core.decision.standing import STARTED
from kurt2rt.core.teaching.commands import Take
from kurt2rt.teacher import TeacherClient
from tests.cli.helpers import Running, running, started
from tests.cli.three_programs import (
    Onlooker,
    drives,
    is_control,
    onlooker,
    stands,
    state_where,
    teacher_of,
    turns,
    until_it_drives,
)
from tests.forked_program import ForkedProgram
from tests.service.systemd.manager import Manager, manager

WATCHDOG_S = 1.0
LOOKED_ON_TICKS = 50


@contextmanager
def starting(
    systemd: Manager, folder: Path, bus: str, module: str, *hangs: str
) -> "Iterator[subprocess.Popen[str] | ForkedProgram]":
    """Start the program as a unit does; kill it at the end, because a failed story would wait for it."""
    environment = systemd.environment(WATCHDOG_S)
    del environment["WATCHDOG_PID"]
    words = ("run", "--service", "--bus", bus, "--port", "0", "--knowledge", "mine.knowledge")
    with started(module, *hangs, *words, folder=folder, environment=environment) as program:
        try:
            yield program
        finally:
            program.kill()


@pytest.mark.deep
async def test_watchdog_kills_a_hanging_loop_and_the_next_stands(tmp_path: Path) -> None:
    bus = f"shared:watched-{uuid.uuid4().hex[:8]}"
    with ExitStack() as around:
        systemd = around.enter_context(manager(tmp_path))
        sim = around.enter_context(running("sim", "--bus", bus, "--start", "1", folder=tmp_path))
        await anyio.to_thread.run_sync(sim.wait_for, f"is on bus {bus}")
        ear = around.enter_context(onlooker(bus))
        with starting(systemd, tmp_path, bus, "tests.service.hanging_program", "drive") as hangs:
            async with teacher_of(Running(hangs), tmp_path) as we:
                assert (await we.send(Take)).accepted
                await until_it_turns(we, ear)
                await anyio.to_thread.run_sync(wait_for_silence, systemd)
                hangs.send_signal(signal.SIGABRT)
                assert await anyio.to_thread.run_sync(hangs.wait) == -signal.SIGABRT
        await ear.until(stands)
        ear.forget()
        with starting(systemd, tmp_path, bus, "kurt2rt.cli.main") as next_one:
            program = Running(next_one)
            async with teacher_of(program, tmp_path) as we:
                back = await state_where(we, lambda state: not math.isinf(state.infrared_age_s))
                assert (back.action, back.stopped) == (None, STARTED)
                assert back.lessons > 0
                await anyio.to_thread.run_sync(systemd.wait_for, "WATCHDOG=1")
                await state_where(we, lambda state: state.tick > back.tick + LOOKED_ON_TICKS)
                ear.look()
                assert any(map(is_control, ear.frames))
                assert not any(map(drives, ear.frames))
                assert (await we.send(Take)).accepted
                await until_it_drives(we)  # it could all the time
            assert (await anyio.to_thread.run_sync(program.end, signal.SIGTERM)).exit_code == 0


async def until_it_turns(we: TeacherClient, ear: Onlooker) -> None:
    """Teach it to drive; the program hangs as soon as it does."""
    async with anyio.create_task_group() as tasks:
        tasks.start_soon(until_it_drives, we)
        await ear.until(turns)
        tasks.cancel_scope.cancel()


def wait_for_silence(systemd: Manager) -> None:
    """Wait until the pings cease."""
    while systemd.hears("WATCHDOG=1", within_s=WATCHDOG_S):
        pass
