"""Parts of the batch that have a law of their own are held equal to the parts on the CAN bus."""

import math
import random
from typing import Any

import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from hal.guard_limits import limited, limits_of, slewed
from hal.robot import SensorReadings, WheelSpeeds
from hal.sensor_watch import SensorWatch
from hal.wheel_watch import WheelWatch
from kurt2rt.core.task_settings import load_task
from simbridge.batch.compiled import compiled
from simbridge.batch.laws import World
from simbridge.batch.safety import looks_broken
from simbridge.batch.setup import build_body_law, build_robots, build_watch_law
from simbridge.batch.sight import cast, gather, has_moved, may_touch
from simbridge.contracts.batch import PolicyMind, TabledPolicy
from simbridge.contracts.simulation import Pose
from simbridge.robot.ray_caster import RayCaster
from simbridge.robot.wheels import Wheels
from simbridge.simulated_robot import SimulatedKurt2
from tests.simbridge.batch.both_ways import FACTORY, ROBOT

_limited = compiled(limited, slewed)


def _standing_in(world: str) -> tuple[SimulatedKurt2, Any, World]:
    """Return a simulated robot, its record in a batch, and the batch's worlds."""
    simulation = FACTORY.open(world, 1, "exam")
    simulation.close()
    policy = load_task("fleeing").policy.build(ROBOT.infrared)
    assert isinstance(policy, TabledPolicy)
    robots, worlds = build_robots(ROBOT, [simulation.simulated_robot], [PolicyMind(policy)], [-1])
    return simulation.simulated_robot, robots[0], worlds


@pytest.mark.parametrize("world", ["a", "two_objects"])
def test_rays_hit_what_the_ray_caster_hits(world: str) -> None:
    simulated, record, worlds = _standing_in(world)
    chance, caster = random.Random(world), RayCaster(simulated.world, 0.9)
    width_m, height_m = simulated.world.settings.size_m
    for _ in range(300):
        x_m, y_m, towards_rad = chance.uniform(0, width_m), chance.uniform(0, height_m), chance.uniform(-4, 4)
        record["x_m"], record["y_m"] = x_m, y_m
        assert gather(record, worlds)
        caster.set_origin(x_m, y_m)
        along = math.cos(towards_rad), math.sin(towards_rad)
        assert cast(record, (x_m, y_m), along, 0.66) == caster.distance_m(x_m, y_m, *along, 0.66)


@pytest.mark.parametrize("world", ["a", "two_objects"])
def test_may_touch_is_false_only_where_the_body_is_free(world: str) -> None:
    simulated, record, worlds = _standing_in(world)
    settings, chance = simulated.world.settings, random.Random(world)
    room, law = settings.free_space, build_body_law(ROBOT, simulated.body)
    width_m, height_m = settings.size_m
    shapely.prepare(room)
    touched = 0
    for _ in range(400):
        pose = Pose(chance.uniform(0, width_m), chance.uniform(0, height_m), chance.uniform(-4, 4))
        if not shapely.contains_xy(room, pose.x_m, pose.y_m):
            continue
        record["x_m"], record["y_m"], record["heading_rad"] = pose
        assert not has_moved(record) or gather(record, worlds)
        clear_m, touches = settings.clearance_m(pose, ROBOT.geometry), may_touch(record, worlds.reach_m, law)
        touched += touches
        assert touches == (clear_m < 1e-4)
    assert touched > 20


_SPEEDS = st.floats(-0.6, 0.6) | st.just(0.0)


@given(
    left_m_s=_SPEEDS, right_m_s=_SPEEDS, present_m_s=_SPEEDS, bumpers=st.integers(0, 15), elapsed_s=st.floats(0.0, 0.02)
)
def test_compiled_limits_round_as_those_of_the_guard(
    left_m_s: float, right_m_s: float, present_m_s: float, bumpers: int, elapsed_s: float
) -> None:
    limits = limits_of(ROBOT)
    asked = (left_m_s, right_m_s), (present_m_s, 0.0), bumpers, elapsed_s, limits
    assert _limited(*asked) == limited(*asked)


@given(seed=st.integers(0, 2**32 - 1), quiet=st.integers(0, 17))
def test_watch_finds_a_sign_when_the_sensor_watch_does(seed: int, quiet: int) -> None:
    _, record, _ = _standing_in("a")
    chance, watch = random.Random(seed), SensorWatch(ROBOT)
    law = build_watch_law(ROBOT)
    counts = [chance.randint(70, 550) for _ in range(18)]
    for tick in range(1, 700):
        for i in range(18):
            if chance.random() < 0.2:
                noise = 0 if i == quiet else round(chance.gauss(0, max(1.5, 0.02 * counts[i])))
                counts[i] = min(560, max(60, counts[i] + noise + chance.choice((0, 0, 0, 0, 60, -60))))
        record["counts"][:] = counts
        record["turned"], record["tick"] = 1, tick
        left, right = chance.randint(-200, 200), chance.randint(-200, 200)
        record["left_ticks"], record["right_ticks"] = left, right
        readings = SensorReadings(0.0, tuple(counts), 0.0, left, right, 0.0, 0, 0.0)
        looks, found = looks_broken(record, law), watch.update(readings, driving=True)
        assert looks or not found
        if looks:
            return


Targets = list[tuple[float, int]]


@given(targets=st.lists(st.tuples(st.floats(-0.6, 0.6), st.integers(1, 60)), min_size=1, max_size=16))
def test_wheels_of_a_robot_that_is_put_obey_too(targets: Targets) -> None:
    assert_obeys(targets, put_every=100)


def assert_obeys(targets: Targets, put_every: int | None) -> None:
    """Check that the watch of the wheels never acts; `put_every`: ticks after which the wheels are held."""
    wheels, watch = Wheels(ROBOT), WheelWatch(ROBOT)
    tick, told_m_s = 0, 0.0
    for target_m_s, ticks in targets:
        for _ in range(ticks):
            tick += 1
            if put_every is not None and tick % put_every == 0:
                wheels.halt()
            wheels.turn(told_m_s, -told_m_s)
            assert watch.check(*wheels.take_ticks(), ROBOT.cycle_s, ROBOT.cycle_s, tick * ROBOT.cycle_s) == ""
            told_m_s = int(target_m_s * 100) / 100
            watch.set_command(WheelSpeeds(told_m_s, -told_m_s))
