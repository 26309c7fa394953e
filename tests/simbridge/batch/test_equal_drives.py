"""Robots in a batch drive as on the CAN bus, bit by bit."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.lockstep.exam import ExamSetup
from simbridge.batch.compiled import IS_COMPILED
from tests.experiments.helpers import short_task, teach
from tests.simbridge.batch.both_ways import drive_in_batch, drive_on_bus, first_difference

SECONDS = 4.0 if IS_COMPILED else 0.5
DRIVES = [("wall_following", "rooms-1000"), ("eight", "two_objects")]


@pytest.mark.parametrize(("name", "world"), DRIVES)
def test_policy_drives_alike_in_the_batch(name: str, world: str) -> None:
    task = load_task(name, changes={"exam.duration_s": str(max(1.0, SECONDS))})
    setups = [ExamSetup(world, seed, teacher_policy=True) for seed in (1, 2)]
    driven = drive_in_batch(task, setups)
    for setup, batch in zip(setups, driven, strict=True):
        assert first_difference(drive_on_bus(task, setup), batch) == ""


def test_taught_robots_and_policies_share_a_batch(tmp_path: Path) -> None:
    taught = teach(tmp_path / "k", short_task(exam_s=max(1.0, SECONDS)))
    exams = [ExamSetup(world, 1, events=taught.events) for world in ("a", "b", "c")]
    exams.append(ExamSetup("a", 1, teacher_policy=True))
    driven = drive_in_batch(taught.task, exams)
    assert any(step.rla_id is not None for step in driven[0].steps)
    for setup, batch in zip(exams, driven, strict=True):
        assert first_difference(drive_on_bus(taught.task, setup), batch) == ""


def test_without_the_compiler_the_numbers_are_the_same() -> None:
    code = (
        "from tests.simbridge.batch.test_equal_drives import *\n"
        "task = load_task('wall_following', changes={'exam.duration_s': '1'})\n"
        "setup = ExamSetup('a', 3, teacher_policy=True)\n"
        "print(IS_COMPILED, drive_in_batch(task, [setup])[0].state_hash)"
    )
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    told = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True, timeout=120
    )
    task = load_task("wall_following", changes={"exam.duration_s": "1"})
    bus = drive_on_bus(task, ExamSetup("a", 3, teacher_policy=True))
    assert told.stdout.split() == ["False", bus.state_hash]


@pytest.mark.parametrize(("world", "seed"), [("a", 1)])
def test_robot_collides_in_the_batch_as_on_the_bus(world: str, seed: int) -> None:
    assert collide(world, seed, 12.0 if IS_COMPILED else 3.0) > 0


@pytest.mark.deep
@pytest.mark.skipif(not IS_COMPILED, reason="plain Python takes minutes")
@pytest.mark.parametrize("seed", range(20, 24))
@pytest.mark.parametrize("world", ["a", "b", "c", "rooms-1001", "floors-2"])
def test_robot_meets_many_walls_in_the_batch_as_on_the_bus(world: str, seed: int) -> None:
    collide(world, seed, 40.0)


def collide(world: str, seed: int, seconds: float) -> int:
    """Check that a drive against walls is equal both ways, and return its collisions."""
    # With its thresholds at the least the policy does not turn away in time.
    least = dict.fromkeys(("policy.front_m", "policy.edge_m", "policy.wary_m"), "0.05")
    changes = {"exam.duration_s": str(seconds), "exam.stuck_after_s": "100", **least}
    task = load_task("fleeing", changes=changes)
    setup = ExamSetup(world, seed, teacher_policy=True)
    (batch,) = drive_in_batch(task, [setup])
    bus = drive_on_bus(task, setup)
    assert batch.left or first_difference(bus, batch) == ""
    return batch.collisions
