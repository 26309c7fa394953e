"""can-utils and the interface itself, with the simulated robot and the runtime as with the real ones.

Programs as a person starts them, on the kernel's vcan0 and its own clock, which in simulated time waits for each of
them; `test_programs` runs this in a machine of that kind.
"""

import asyncio
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import NamedTuple

import anyio
import anyio.to_thread
import pytest
import yaml

from config import CONFIG_DIR
from hal.bus import CONTROL_ID, open_bus
from hal.guard_reason import GuardReason
from hal.kurt2 import Kurt2
from kurt2rt.channel.protocol.state import State
from kurt2rt.core.decision.standing import ActiveStop, StopReason
from kurt2rt.core.teaching.commands import Resume, Take, Teach
from kurt2rt.teacher import TeacherClient
from tests.cli.helpers import Running, running
from tests.cli.three_programs import (
    CODEC,
    ENCODER,
    LONG_ENOUGH_S,
    ROBOT,
    brakes,
    drives,
    is_control,
    kept_driving,
    onlooker,
    runtime,
    stands,
    state_where,
    teacher_of,
    turns,
    until_it_drives,
)
from tests.hil.can_utils import Line, candump, cansend, cantools_decode, doing, lines_of
from tests.hil.link import NAME, Link

STOP = "001#00000103FF0103FF"
SLOWLY = "0002000A000A0001"
INFRARED = ("ADC00_03", "ADC04_07", "ADC08_11", "BDC00_03", "BDC04_07")


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


async def test_candump_shows_all_frames_and_cantools_decodes_them(vcan0: str, tmp_path: Path) -> None:
    async with at_work(vcan0, tmp_path):
        log = await anyio.to_thread.run_sync(candump, vcan0, 2000)
    lines = lines_of(log)
    names = [CODEC.by_id[line.frame_id].name if line.frame_id != CONTROL_ID else "CONTROL" for line in lines]
    assert {"CONTROL", *INFRARED, "ENCODER", "BUMPERC", "INFO_1", "INFO_2", "GYRO_MC1", "DEADRECK"} <= set(names)
    span_s = lines[-1].time_s - lines[0].time_s
    for name in ("CONTROL", "ENCODER"):
        # 100 a second at most; a machine that has much to do misses some, and how many is not this test's matter.
        assert 20 * span_s < names.count(name) <= 100 * span_s + 2
    told = cantools_decode(log).splitlines()
    assert len(told) == len(lines)
    for name, line in zip(names, told, strict=True):
        assert f":: {name}(" in line


async def test_cansend_emergency_stop_stops_robot_and_runtime(vcan0: str, tmp_path: Path) -> None:
    async with at_work(vcan0, tmp_path) as (_, robot, we):
        with onlooker(vcan0) as seen:
            stopped = await _stopped_by_cansend(vcan0, we)
            assert (stopped.left_m_s, stopped.right_m_s) == (0.0, 0.0)
            await seen.until(stands)
            seen.forget()
            passed = await seen.until(lambda frame: frame.arbitration_id == CODEC.message("INFO_1").frame_id)
            assert not any(turns(frame) or drives(frame) for frame in passed)
            assert all(brakes(frame) for frame in passed if is_control(frame))
        await anyio.to_thread.run_sync(robot.wait_for, f"guard: {GuardReason.FOREIGN_CONTROL}")
        await until_it_drives(we)  # after resume


async def _stopped_by_cansend(bus: str, we: TeacherClient) -> State:
    """Stop the robot by cansend; try again if a busy machine stopped it first."""
    while True:
        await until_it_drives(we, "spin_left")
        await anyio.to_thread.run_sync(cansend, bus, STOP)
        state = await state_where(we, lambda state: state.stopped is not None)
        if GuardReason.FOREIGN_CONTROL in state.guard:
            return state


async def test_cangen_drives_and_stops_a_robot_without_runtime(vcan0: str, tmp_path: Path) -> None:
    with running("sim", "--bus", vcan0, folder=tmp_path) as sim, onlooker(vcan0) as seen:
        await anyio.to_thread.run_sync(sim.wait_for, f"is on bus {vcan0}")
        with doing("cangen", vcan0, "-I", "001", "-L", "8", "-D", SLOWLY, "-g", "10"):
            await seen.until(turns)
            await anyio.to_thread.run_sync(sim.wait_for, "CONTROL is heard and obeyed")
        await seen.until(stands)
        await anyio.to_thread.run_sync(sim.wait_for, "CONTROL has ceased: the watchdog brakes")


@pytest.mark.parametrize("flood", [("-I", "300"), ("-e", "-I", "1"), ("-R", "-I", "301")], ids=" ".join)
async def test_flood_of_unused_frames_disturbs_neither_program(
    vcan0: str, tmp_path: Path, flood: tuple[str, ...]
) -> None:
    async with at_work(vcan0, tmp_path) as (_, _, we):
        with onlooker(vcan0) as seen, doing("cangen", vcan0, "-g", "1", *flood) as cangen:
            async with kept_driving(we, "spin_left"):
                for _ in range(3):
                    await seen.until(lambda frame: frame.is_extended_id or frame.arbitration_id in (0x300, 0x301))
                    await seen.until(drives)
                    await seen.until(turns)
                assert (await state_where(we, lambda state: state.rla == 1)).trouble == ""
            assert cangen.poll() is None


async def test_interface_down_and_up_stops_both_and_ends_neither(link: Link, tmp_path: Path) -> None:
    async with at_work(NAME, tmp_path) as (sim, robot, we):
        await anyio.to_thread.run_sync(link.down)
        await anyio.to_thread.run_sync(sim.wait_for, "lost: bus vcan0: ")
        await anyio.to_thread.run_sync(sim.wait_for, "CONTROL has ceased: the watchdog brakes")
        stopped = await state_where(
            we, lambda state: state.stopped == ActiveStop(StopReason.GUARD, GuardReason.BUS_LOST)
        )
        assert stopped.trouble.startswith("bus vcan0: ")
        await anyio.to_thread.run_sync(robot.wait_for, f"guard: {GuardReason.BUS_LOST}")
        await anyio.to_thread.run_sync(link.up)
        await anyio.to_thread.run_sync(sim.wait_for, "the bus is there again")
        await until_it_drives(we)
        assert robot.process.poll() is None


async def test_an_adapter_that_is_unplugged_and_plugged_in_again(link: Link, tmp_path: Path) -> None:
    async with at_work(NAME, tmp_path) as (sim, _, we):
        await anyio.to_thread.run_sync(link.delete)
        await state_where(we, lambda state: state.stopped == ActiveStop(StopReason.GUARD, GuardReason.BUS_LOST))
        await anyio.to_thread.run_sync(sim.wait_for, "such network interface")
        await anyio.to_thread.run_sync(link.make)
        await anyio.to_thread.run_sync(sim.wait_for, "the bus is there again")
        await until_it_drives(we)


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


class Recorded(NamedTuple):
    """A candump log of a robot that was driven a little, without CONTROL, and what is in it."""

    log: Path
    counts: set[tuple[int, ...]]
    """Readings of all sensors after each frame."""
    ticks: tuple[int, int]
    """Total encoder ticks of each side."""


@pytest.fixture
def recorded(vcan0: str, tmp_path: Path) -> Recorded:
    with running("sim", "--bus", vcan0, folder=tmp_path) as sim:
        sim.wait_for(f"is on bus {vcan0}")
        with doing("cangen", vcan0, "-I", "001", "-L", "8", "-D", SLOWLY, "-g", "10"):
            sim.wait_for("CONTROL is heard and obeyed")
            log = candump(f"{vcan0},001~7FF", 1500)
    path = tmp_path / "recorded.log"
    path.write_text(log, encoding="ascii")
    lines = lines_of(log)
    encoder = [ENCODER.unpack(line.data) for line in lines if line.frame_id == ENCODER.frame_id]
    assert any(left for left, _ in encoder)
    ticks = sum(left for left, _ in encoder), sum(right for _, right in encoder)
    return Recorded(path, set(counts_in(lines * 2)), ticks)  # twice, for it may be played round and round


def counts_in(lines: list[Line]) -> Iterator[tuple[int, ...]]:
    """Yield the readings of all sensors, in the order of the sensor table, after each frame."""
    channels = dict.fromkeys((sensor.channel for sensor in ROBOT.infrared.sensors), 0)
    yield tuple(channels.values())
    for line in lines:
        codec = CODEC.by_id[line.frame_id]
        for signal, value in zip(codec.signals, codec.unpack(line.data), strict=True):
            if signal in channels:
                channels[signal] = value
        yield tuple(channels.values())


async def test_a_log_that_canplayer_plays_is_sensed_as_it_was_recorded(vcan0: str, recorded: Recorded) -> None:
    kurt2 = Kurt2(ROBOT, open_bus(vcan0))
    ticks, sensed = [0, 0], set()
    with doing("canplayer", "-I", str(recorded.log)) as canplayer:
        now_s, left_to_look = 0.0, 5
        while left_to_look:
            left_to_look -= canplayer.poll() is not None
            now_s += ROBOT.cycle_s
            readings = kurt2.sense(now_s)
            ticks[0] += readings.encoder_left_ticks
            ticks[1] += readings.encoder_right_ticks
            sensed.add(readings.infrared_counts)
            await asyncio.sleep(ROBOT.cycle_s)
    kurt2.close()
    assert tuple(ticks) == recorded.ticks
    assert len(sensed) > 50
    assert sensed <= recorded.counts


async def test_a_log_that_canplayer_plays_drives_the_runtime(vcan0: str, tmp_path: Path, recorded: Recorded) -> None:
    with doing("canplayer", "-l", "i", "-I", str(recorded.log)), runtime(vcan0, tmp_path) as robot:
        async with teacher_of(robot, tmp_path) as we:
            assert (await we.send(Take)).accepted
            assert (await we.send(Resume)).accepted
            asks = await state_where(we, lambda state: state.cause == "unknown")
            assert asks.infrared_counts in recorded.counts
            assert (await we.send(Teach, action="stand", decision_tick=asks.tick)).accepted
            with anyio.fail_after(LONG_ENOUGH_S):
                seen = 0
                async for state in we.states():
                    assert state.infrared_counts in recorded.counts
                    seen += state.rla == 1
                    if seen >= 10:
                        break


async def test_a_log_that_the_runtime_keeps_is_played_by_canplayer(vcan0: str, tmp_path: Path) -> None:
    async with at_work(vcan0, tmp_path, "--can-log", "drive.log") as (_, robot, _):
        await anyio.to_thread.run_sync(robot.wait_for, " s | ")
        robot.process.terminate()
        await anyio.to_thread.run_sync(robot.wait_for, "frames are in drive.log")
    kept = lines_of((tmp_path / "drive.log").read_text(encoding="ascii"))
    assert {CONTROL_ID, ENCODER.frame_id} <= {line.frame_id for line in kept}
    with onlooker(vcan0) as seen, doing("canplayer", "-t", "-I", str(tmp_path / "drive.log")):
        for line in kept:
            (*_, frame) = await seen.until(lambda _: True)
            assert (frame.arbitration_id, bytes(frame.data)) == (line.frame_id, line.data)
