"""The robot program is halted by SIGSTOP, 50 ms to 10 s: the robot stands within its limits and does not drive on."""

from pathlib import Path

import pytest

from tests.crash.stop_story import MOST_CYCLES_TO_REST, ROBOT, Stopped, a_robot_that_turns

TICKS_CEASED_S = ROBOT.guard.ticks_ceased_s
SLACK_S = 0.02
"""The watchdog looks every 10 ms, and a frame takes its time."""


def require_safe(stopped: Stopped) -> None:
    """By the gap that the bus saw: on a machine that has much to do it may be longer than the stop."""
    if stopped.cycles_to_rest is not None:
        assert stopped.cycles_to_rest <= MOST_CYCLES_TO_REST
    if stopped.gap_s > TICKS_CEASED_S + SLACK_S:
        assert stopped.drove_on == 0
        assert stopped.state.stopped_because  # by the watchdog, and by the teacher's lease
        assert (stopped.state.left_m_s, stopped.state.right_m_s) == (0.0, 0.0)


async def test_a_program_that_was_halted_does_not_drive_on_before_it_is_told_to(tmp_path: Path) -> None:
    async with a_robot_that_turns(tmp_path, "shared:halted") as story:
        stopped = await story.stop_for(0.6, until_it_rests=True)
        assert stopped.gap_s > 0.5
        assert stopped.cycles_to_rest is not None
        require_safe(stopped)


@pytest.mark.deep
async def test_it_is_so_however_long_it_was_halted(tmp_path: Path) -> None:
    async with a_robot_that_turns(tmp_path, "shared:halted-long") as story:
        for seconds in (0.05, 0.08, 0.1, 0.12, 0.15, 0.2, 0.25, 0.3, 0.5, 1.0, 2.0, 5.0, 10.0) * 3:
            stopped = await story.stop_for(seconds)
            print(
                f"halted {seconds:5.2f} s, gap {stopped.gap_s:6.3f} s, {stopped.cycles_to_rest} cycles to rest, "
                f"{stopped.drove_on} CONTROL frames that drive, {stopped.state.stopped_because or 'not stopped'}"
            )
            require_safe(stopped)
