"""Simulated infra-red sensors, and the ray caster behind them."""

import math

import pymunk
import pytest

from simbridge.contracts.world_refusal import WorldRefusedError
from simbridge.robot.ray_caster import RayCaster
from simbridge.robot.world import World
from tests.simbridge.rig import STAND, Rig, board, box, facing_wall, post, quiet_robot, room


@pytest.mark.parametrize(
    ("distance_m", "counts"),
    [
        *[(0.10, 550), (0.15, 388), (0.30, 189), (0.50, 95), (0.60, 70)],
        *[(0.08, 550), (0.05, 425), (0.03, 300), (0.005, 144)],  # too near: readings fold back
    ],
)
def test_readings_follow_the_infrared_law(distance_m: float, counts: int, quiet_rig: Rig) -> None:
    quiet_rig.seen_from(facing_wall(distance_m), "s11")
    assert [quiet_rig.reading(sensor) for sensor in ("s9", "s10", "s11")] == pytest.approx([counts] * 3, abs=2)


def test_moved_post_and_box_are_seen() -> None:
    block = box((1.0, 1.9), (1.1, 1.9), (1.1, 2.1), (1.0, 2.1))
    with Rig(room(posts=[post(2.9, 2.0, 0.05)], boxes=[block]), robot=quiet_robot()) as rig:
        rig.robot.world.move_wall("post", -0.333, 0.0)
        rig.robot.world.move_wall("box", 0.383, 0.0)
        rig.run(0.1, STAND)
        assert [rig.reading("s11"), rig.reading("s14")] == pytest.approx([189, 189], abs=1)
        with pytest.raises(WorldRefusedError, match=r"'shelf'.*post, box"):
            rig.robot.world.move_wall("shelf", 0.1, 0.0)


def test_ray_caster_agrees_with_the_physics_engine() -> None:
    wall, block = board((1.0, 1.0), (1.6, 1.4), 0.05), box((2.6, 1.0), (3.1, 1.2), (2.7, 1.6))
    world = World(room(walls=[wall], posts=[post(2.4, 2.7, 0.2)], boxes=[block]))
    rays = RayCaster(world, 1.0)
    for step in range(360):
        angle_rad = math.radians(step) + 1e-4
        x_m, y_m = 2.0 + 0.9 * math.cos(step), 2.0 + 0.9 * math.sin(step)
        if world.space.point_query_nearest((x_m, y_m), 0.0, pymunk.ShapeFilter()):
            continue  # within an obstacle
        rays.set_origin(x_m, y_m)
        along = (math.cos(angle_rad), math.sin(angle_rad))
        end = (x_m + 0.8 * along[0], y_m + 0.8 * along[1])
        hit = world.space.segment_query_first((x_m, y_m), end, 0.0, pymunk.ShapeFilter())
        assert rays.distance_m(x_m, y_m, *along, 0.8) == pytest.approx(0.8 * (hit.alpha if hit else 1.0), abs=1e-6)
