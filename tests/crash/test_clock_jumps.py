"""The wall clock is set forward and back by an hour while the robot works: nothing but the stamps goes by it."""

import signal
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from datetime import UTC, datetime
from pathlib import Path

import anyio
import anyio.to_thread
import pytest

from kurt2rt.channel.protocol.state import State
from kurt2rt.core.teaching.commands import Correct, Resume, Take, Teach
from kurt2rt.knowledge.journal.fold import check_knowledge
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.runs.recording.run_folder import find_run, segments_in
from kurt2rt.runs.recording.segment_reader import SegmentReader
from kurt2rt.runs.replay.comparison import compare
from kurt2rt.runs.replay.reader import read_run
from kurt2rt.runs.replay.replay import Replay
from kurt2rt.teacher.client.client import TeacherClient
from tests.cli.helpers import Running, running
from tests.cli.three_programs import LONG_ENOUGH_S, state_where, teacher_of, until_it_drives
from tests.crash.wall_clock import HOUR_S, WallClock

BUS = "shared:clock-jumps"
ON_THE_SPOT, THE_OTHER_WAY = "spin_left", "spin_right"
LATE_S = 600.0
"""A stamp is right that is so near to the wall clock."""


@asynccontextmanager
async def a_robot(folder: Path) -> AsyncIterator[None]:
    with running("sim", "--bus", BUS, folder=folder) as sim:
        await anyio.to_thread.run_sync(sim.wait_for, f"is on bus {BUS}")
        yield


async def taught_the_other_way(we: TeacherClient, wall_clock: WallClock) -> None:
    """Correct the robot until it drives by a correction that has a stamp of the present wall clock.

    A correction teaches nothing if it comes while an action is held that the nearest RLA does not say any more, and
    another RLA may be nearer by the time that it acts. So it is repeated.
    """
    await until_it_drives(we, ON_THE_SPOT)
    before = (await state_where(we, lambda _: True)).lessons

    def acts(state: State, action: str) -> bool:
        if state.lessons <= before or state.nearest_action != action or not state.taught_at:
            return False
        off_by_s = (datetime.fromisoformat(state.taught_at) - datetime.now(UTC)).total_seconds()
        return abs(off_by_s - wall_clock.off_by_s) < LATE_S

    with anyio.fail_after(LONG_ENOUGH_S):
        async for state in we.states():
            if state.rla is not None:
                action, since = THE_OTHER_WAY if state.action == ON_THE_SPOT else ON_THE_SPOT, state.tick
                if (await we.send(Correct, action=action, decision_tick=since)).accepted and await _comes(
                    we, acts, action, since
                ):
                    return
            elif state.stopped:
                await we.send(Resume)
            elif state.cause == "unknown":
                await we.send(Teach, action=ON_THE_SPOT, decision_tick=state.tick)
    raise AssertionError("the client ended")


async def _comes(we: TeacherClient, acts: Callable[[State, str], bool], action: str, since: int) -> bool:
    """Return whether a state comes in which a correction acts, at most half a second after a tick."""
    later = await state_where(we, lambda state: acts(state, action) or state.tick > since + 50)
    return acts(later, action)


def require_kept(folder: Path, lessons: int) -> None:
    with Journal.read_only(folder / "mine.knowledge") as journal:
        assert check_knowledge(journal) == []
        entries = journal.entries()
    assert len(entries) >= lessons
    assert [entry.sequence for entry in entries] == list(range(1, len(entries) + 1))


def require_even(run_folder: Path) -> None:
    """Its times only grow, it is whole, and comes out the same again."""
    times_ns = [
        message.time_ns for each in segments_in(run_folder) for message in SegmentReader(each).messages(("/tick",))
    ]
    assert times_ns == sorted(times_ns)
    assert times_ns[-1] - times_ns[0] < LATE_S * 1e9
    run = read_run(run_folder)
    for entry, record in Replay(run):
        assert compare(entry, record) == []
    assert run.has_no_gap
    assert not run.trouble


async def end(robot: Running) -> None:
    said = await anyio.to_thread.run_sync(robot.end, signal.SIGTERM)
    assert said.exit_code == 0, said
    assert "Traceback" not in said.err


@pytest.mark.deep
async def test_lessons_and_recordings_outlive_a_wall_clock_that_is_set(tmp_path: Path) -> None:
    wall_clock = WallClock(tmp_path)
    words = ("run", "--bus", BUS, "--port", "0", "--knowledge", "mine.knowledge", "--record", "runs")
    async with a_robot(tmp_path):
        with wall_clock.running(*words, folder=tmp_path) as robot:
            async with teacher_of(robot, tmp_path) as we:
                assert (await we.send(Take)).accepted
                await taught_the_other_way(we, wall_clock)
                wall_clock.jump(HOUR_S)
                await taught_the_other_way(we, wall_clock)
                wall_clock.jump(-2 * HOUR_S)
                await taught_the_other_way(we, wall_clock)
            await end(robot)
        first = find_run(None, tmp_path / "runs")
        require_kept(tmp_path, lessons=4)
        require_even(first)

        with wall_clock.running(*words, folder=tmp_path) as robot:
            async with teacher_of(robot, tmp_path) as we:
                assert (await we.send(Take)).accepted
                await taught_the_other_way(we, wall_clock)
            await end(robot)
        newest = find_run(None, tmp_path / "runs")
        assert newest != first, "it was recorded at an earlier time by the wall clock, and is the newest all the same"
        require_kept(tmp_path, lessons=5)
        require_even(newest)
