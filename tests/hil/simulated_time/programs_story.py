"""Programs on the kernel's CAN: an emergency stop by cansend, an interface that is lost, a log for canplayer.

All are started as a person starts them, on vcan0 and its kernel's clock, which in simulated time waits for each of
them; `test_programs` runs this in a machine of that kind.
"""

import subprocess
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path
from typing import NamedTuple

import anyio.to_thread
import pytest
import yaml

from config import CONFIG_DIR
from hal.bus import CONTROL_ID
from hal.guard_reason import GuardReason
from kurt2rt.channel.protocol.state import State
from kurt2rt.core.decision.standing import ActiveStop, StopReason
from kurt2rt.core.teaching.commands import Take
from kurt2rt.teacher import TeacherClient
from tests.cli.helpers import Running, running
from tests.cli.three_programs import (
    CODEC,
    ENCODER,
    brakes,
    drives,
    is_control,
    onlooker,
    runtime,
    stands,
    teacher_of,
    turns,
    until_it_drives,
)
from tests.hil.drive import cansend
from tests.hil.link import NAME, Link
from tests.teacher.states_of import state_where

STOP = "001#00000103FF0103FF"


class AtWork(NamedTuple):
    """A robot that spins on the spot, for one RLA tells it to wherever it is."""

    sim: Running
    robot: Running
    we: TeacherClient


@asynccontextmanager
async def at_work(bus: str, folder: Path, *words: str) -> AsyncIterator[AtWork]:
    with running("sim", "--bus", bus, folder=folder) as sim:
        await anyio.to_thread.run_sync(sim.wait_for, f"is on bus {bus}")
        with runtime(bus, folder, "--settings", str(one_rule_for_all(folder)), *words) as robot:
            async with teacher_of(robot, folder) as we:
                assert (await we.send(Take)).accepted
                await until_it_drives(we, "spin_left")
                yield AtWork(sim, robot, we)


def one_rule_for_all(folder: Path) -> Path:
    """Runtime settings with a confidence radius that no situation is outside of."""
    task = yaml.safe_load((CONFIG_DIR / "tasks" / "wall_following.yaml").read_text(encoding="utf-8"))
    task["learning"]["radius"] = 100_000
    (folder / "task.yaml").write_text(yaml.safe_dump(task), encoding="utf-8")
    service = yaml.safe_load((CONFIG_DIR / "runtime" / "default.yaml").read_text(encoding="utf-8"))
    service["task"] = str(folder / "task.yaml")
    path = folder / "runtime.yaml"
    path.write_text(yaml.safe_dump(service), encoding="utf-8")
    return path


async def test_cansend_emergency_stop_stops_robot_and_runtime(vcan0: str, tmp_path: Path) -> None:
    async with at_work(vcan0, tmp_path) as (_, robot, we):
        with onlooker(vcan0) as seen:
            stopped = await _stopped_by_cansend(we)
            assert (stopped.left_m_s, stopped.right_m_s) == (0.0, 0.0)
            await seen.until(stands)
            seen.forget()
            passed = await seen.until(lambda frame: frame.arbitration_id == CODEC.message("INFO_1").frame_id)
            assert not any(turns(frame) or drives(frame) for frame in passed)
            assert all(brakes(frame) for frame in passed if is_control(frame))
        await anyio.to_thread.run_sync(robot.wait_for, f"guard: {GuardReason.FOREIGN_CONTROL}")
        await until_it_drives(we)  # after resume


async def _stopped_by_cansend(we: TeacherClient) -> State:
    """Stop the robot by cansend; try again if a busy machine stopped it first."""
    while True:
        await until_it_drives(we, "spin_left")
        await anyio.to_thread.run_sync(cansend, STOP)
        state = await state_where(we, lambda state: state.stopped is not None)
        if GuardReason.FOREIGN_CONTROL in state.guard:
            return state


@pytest.mark.parametrize(
    ("lost", "found", "told", "trouble"),
    [
        (Link.down, Link.up, "lost: bus vcan0: ", "bus vcan0: "),
        (Link.delete, Link.make, "such network interface", "bus 'vcan0': no such network interface"),
    ],
    ids=["down", "unplugged"],
)
async def test_interface_lost_and_found_stops_both_and_ends_neither(
    link: Link, tmp_path: Path, lost: Callable[[Link], None], found: Callable[[Link], None], told: str, trouble: str
) -> None:
    async with at_work(NAME, tmp_path) as (sim, robot, we):
        await anyio.to_thread.run_sync(lost, link)
        await anyio.to_thread.run_sync(sim.wait_for, told)
        stopped = await state_where(
            we, lambda state: state.stopped == ActiveStop(StopReason.GUARD, GuardReason.BUS_LOST)
        )
        assert stopped.trouble.startswith(trouble)
        await anyio.to_thread.run_sync(robot.wait_for, f"guard: {GuardReason.BUS_LOST}")
        await anyio.to_thread.run_sync(found, link)
        await anyio.to_thread.run_sync(sim.wait_for, "the bus is there again")
        await until_it_drives(we)
        assert robot.process.poll() is None


@pytest.mark.parametrize("words", [("sim", "--bus", NAME), ("run", "--bus", NAME)], ids=" ".join)
def test_an_interface_that_is_down_is_told_in_a_line(link: Link, tmp_path: Path, words: tuple[str, ...]) -> None:
    link.down()
    with running(*words, folder=tmp_path) as program:
        out, err = program.process.communicate()
    assert program.process.returncode == 2
    assert "Traceback" not in out + err
    (line,) = err.splitlines()
    assert "vcan0" in line
    assert "down" in line


@contextmanager
def played(log: Path) -> Iterator[None]:
    """Let canplayer send the frames of a log."""
    words = ("canplayer", "-t", "-I", str(log))
    with subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL) as canplayer:
        try:
            yield
        finally:
            canplayer.kill()


async def test_a_log_that_the_runtime_keeps_is_played_by_canplayer(vcan0: str, tmp_path: Path) -> None:
    async with at_work(vcan0, tmp_path, "--can-log", "drive.log") as (_, robot, _):
        await anyio.to_thread.run_sync(robot.wait_for, " s | ")
        robot.process.terminate()
        await anyio.to_thread.run_sync(robot.wait_for, "frames are in drive.log")
    lines = (tmp_path / "drive.log").read_text(encoding="ascii").splitlines()
    kept = [line.split()[2].partition("#")[::2] for line in lines]  # (stamp) interface identifier#data
    assert {CONTROL_ID, ENCODER.frame_id} <= {int(identifier, 16) for identifier, _ in kept}
    with onlooker(vcan0) as seen, played(tmp_path / "drive.log"):
        for identifier, data in kept:
            (*_, frame) = await seen.until(lambda _: True)
            assert (frame.arbitration_id, bytes(frame.data)) == (int(identifier, 16), bytes.fromhex(data))
