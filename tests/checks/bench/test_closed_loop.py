"""The closed loop in lockstep, and the core it keeps to."""

import os
import re
import threading
from pathlib import Path

import pytest

from kurt2rt.checks.bench.closed_loop import measure_closed_loop, on_one_core
from kurt2rt.checks.bench.robot_under_test import BenchFixture


async def test_blocks_are_timed_whole_and_one_by_one(subject: BenchFixture, tmp_path: Path) -> None:
    told: list[float] = []
    result, share = await measure_closed_loop(subject, tmp_path, 2, 1, told.append)
    assert told == [0.5, 1.0]
    assert re.findall(r"\d+", result.note)[:2] == ["2", "100"]
    assert 0.0 < result.took.median_us <= result.took.worst_us
    assert result.reference is not None
    assert result.reference.ratio == pytest.approx(10_000 / result.took.median_us)
    (goal,) = result.goals
    assert goal.at_least
    assert goal.measured == result.reference.ratio
    assert 0.0 < share.took.median_us < result.took.worst_us


def test_on_one_core_pins_thread_and_its_children_until_the_end() -> None:
    before = os.sched_getaffinity(0)
    inherited: list[set[int]] = []
    with on_one_core() as core:
        assert os.sched_getaffinity(0) == {core}
        thread = threading.Thread(target=lambda: inherited.append(os.sched_getaffinity(0)))
        thread.start()
        thread.join()
    assert inherited == [{core}]
    assert os.sched_getaffinity(0) == before


def test_an_error_gives_the_cores_back_too() -> None:
    before = os.sched_getaffinity(0)
    with pytest.raises(KeyError), on_one_core():
        raise KeyError
    assert os.sched_getaffinity(0) == before
