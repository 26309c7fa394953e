"""The robot program is halted by SIGSTOP, 50 ms to 10 s: the robot stands within its limits and does not drive on."""

from pathlib import Path

import pytest

from tests.crash.stop_story import MOST_CYCLES_TO_REST, ROBOT, Stopped, a_robot_that_turns

TICKS_CEASED_S = ROBOT.guard.ticks_ceased_s
SLACK_S = 0.02
"""The watchdog looks every 10 ms, and a frame takes its time."""
MOST_AT_ONCE = round(ROBOT.guard.command_age_s / ROBOT.cycle_s) + 2
"""CONTROL frames in the time that a command may be old: one per cycle, one that is late and one that comes at its time.
What was decided before a halt and said after it would come on top."""
SHORT_S = 0.08


def require_safe(stopped: Stopped) -> None:
    """Assert safety by the gap on the bus, which may be longer than the stop on a busy machine."""
    if stopped.cycles_to_rest is not None:
        assert stopped.cycles_to_rest <= MOST_CYCLES_TO_REST
    if stopped.gap_s > TICKS_CEASED_S + SLACK_S:
        assert stopped.drove_on == 0
        assert stopped.state.stopped  # by the watchdog, and by the teacher's lease
        assert (stopped.state.left_m_s, stopped.state.right_m_s) == (0.0, 0.0)
    elif stopped.gap_s < TICKS_CEASED_S - SLACK_S:
        assert stopped.drove_on > 0
    assert stopped.most_at_once <= MOST_AT_ONCE


async def test_halted_program_drives_on_at_once_or_only_after_resume(tmp_path: Path) -> None:
    async with a_robot_that_turns(tmp_path, "shared:halted") as story:
        stopped = await story.stop_for(0.05)
        while stopped.gap_s > SHORT_S:  # the machine has much to do
            stopped = await story.stop_for(0.05)
        require_safe(stopped)
        assert stopped.cycles_to_rest is None
        assert stopped.drove_on > 0

        stopped = await story.stop_for(0.6, until_it_rests=True)
        assert stopped.gap_s > 0.5
        assert stopped.cycles_to_rest is not None
        require_safe(stopped)


@pytest.mark.deep
async def test_it_is_so_however_long_it_was_halted(tmp_path: Path) -> None:
    async with a_robot_that_turns(tmp_path, "shared:halted-long") as story:
        short: list[Stopped] = []
        for seconds in (0.05, 0.08, 0.1, 0.12, 0.15, 0.2, 0.25, 0.3, 0.5, 1.0, 2.0, 5.0, 10.0) * 3:
            stopped = await story.stop_for(seconds)
            print(
                f"halted {seconds:5.2f} s, gap {stopped.gap_s:6.3f} s, {stopped.cycles_to_rest} cycles to rest, "
                f"{stopped.drove_on} CONTROL frames that drive, {stopped.most_at_once} of them at once, "
                f"{stopped.state.stopped or 'not stopped'}"
            )
            require_safe(stopped)
            if seconds <= SHORT_S:
                short.append(stopped)
        drove_on = sum(stopped.drove_on > 0 for stopped in short)
        print(f"{drove_on} of {len(short)} short halts were driven through")
        assert drove_on >= len(short) / 2  # the others are the machine's, which has other things to do
