"""A simulated robot that was taught for a moment, for benchmarks of a few ticks."""

import anyio
import pytest

from hal.kurt2_settings import load_kurt2
from kurt2rt.checks.bench.robot_under_test import SEED, BenchFixture, learn
from kurt2rt.core.task_settings import load_task
from simbridge.simulation import Kurt2SimulationFactory


@pytest.fixture(scope="session")
def untaught() -> BenchFixture:
    settings, task = load_kurt2(), load_task("wall_following")
    stage = Kurt2SimulationFactory(settings)
    return BenchFixture(settings, task, lambda purpose: stage.open(task.teaching.world, SEED, purpose), batches=stage)


@pytest.fixture(scope="session")
def subject(untaught: BenchFixture) -> BenchFixture:
    return anyio.run(learn, untaught, 5.0, lambda _: None)
