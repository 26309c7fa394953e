"""The robot program is killed at random moments while it is taught: the robot stands, and no lesson is lost."""

import os
from pathlib import Path

import pytest

from tests.crash.kill_story import KillStory

KILLS_OF_A_SHARD = 50


async def test_killed_program_robot_stands_and_no_lesson_is_lost(tmp_path: Path) -> None:
    tally = await KillStory(tmp_path, f"shared:killed-twice-{os.getpid()}", seed=7, longest_life_s=50.0).run(kills=2)
    assert tally.kills == 2
    assert tally.stored >= tally.acknowledged > 0


@pytest.mark.deep
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("shard", range(4))
async def test_it_is_so_in_two_hundred_kills(tmp_path: Path, shard: int) -> None:
    tally = await KillStory(tmp_path, f"shared:killed-{shard}-{os.getpid()}", seed=2004 + shard).run(KILLS_OF_A_SHARD)
    print(tally)
    assert tally.kills == KILLS_OF_A_SHARD
    assert tally.stored >= tally.acknowledged > KILLS_OF_A_SHARD // 2
    assert tally.driving > KILLS_OF_A_SHARD // 5
