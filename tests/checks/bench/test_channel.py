"""Short measurement of the channel: a real robot program, real helper processes, real frames and lessons."""

from dataclasses import replace
from pathlib import Path

import pytest

from kurt2rt.checks.bench.channel import ChannelLengths
from kurt2rt.checks.bench.channel_load import LoadShifts
from kurt2rt.checks.bench.helper_process import HelperLostError
from kurt2rt.checks.bench.open_robot import open_robot
from kurt2rt.checks.bench.result import BenchGoal
from kurt2rt.checks.bench.robot_under_test import BenchFixture, OnProgress
from kurt2rt.checks.bench.suite import QUICK, BenchName, run_suite
from kurt2rt.knowledge.journal.loading import open_knowledge

SHORT = replace(
    QUICK, learning_s=3.0, channel=ChannelLengths(presses=1, shifts=LoadShifts(rounds=1, ticks=20), lessons=2)
)


@pytest.mark.deep
async def test_presses_reach_the_wheels_and_lessons_the_file(untaught: BenchFixture, tmp_path: Path) -> None:
    told: dict[str, list[float]] = {}

    def start_job(what: str) -> OnProgress:
        return told.setdefault(what, []).append

    results, errors = await run_suite({BenchName.CHANNEL}, untaught, tmp_path, SHORT, start_job)
    assert errors == ()
    pressed, on_page, late, work, picture, message, lesson = results
    assert {result.bench for result in results} == {"channel"}
    assert all(shares[-1] == 1.0 for shares in told.values())
    assert len(told) == 5
    for result in (pressed, on_page):
        assert result.goals[-1] == BenchGoal("lost", 0, 0)
        assert 0.0 < result.took.median_us <= result.took.worst_us
    assert late.took.worst_us > 0.0
    assert [each.what.split()[-1] for each in (work, picture, message)] == ["second", "picture", "message"]
    assert lesson.took.median_us > 0.0
    with open_knowledge(tmp_path / "lessons" / "bench.knowledge", untaught.settings, untaught.task) as journal:
        taught = [event.origin for event in journal.events()]
    assert [origin.teacher for origin in taught[-5:]] == ["local"] * 5
    assert [origin.command_id for origin in taught[-2:]] == ["bench-inside-0", "bench-inside-1"]


async def test_open_robot_stands_untaught_and_closes_on_failure(subject: BenchFixture, tmp_path: Path) -> None:
    async def lose_a_partner() -> None:
        async with open_robot(subject, tmp_path / "robot") as robot:
            await robot.gate.run_ticks(5)
            assert robot.gate.driving == 0
            assert robot.observer.starts == []
            number = robot.gate.newest.tick if robot.gate.newest is not None else 0
            robot.pace.shift(0.004)
            await robot.gate.run_ticks(5)
            assert robot.gate.newest is not None
            assert robot.gate.newest.tick > number
            raise HelperLostError

    with pytest.raises(HelperLostError):
        await lose_a_partner()
