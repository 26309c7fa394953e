"""Random rooms: convex and concave corners, slanted walls, a spur wall, tables, a displaced wall."""

import math

from simbridge.worlds.generator.room_plan import RoomPlan
from simbridge.worlds.generator.seeded_random import SeededRandom
from simbridge.worlds.generator.starts import starts_along_walls
from simbridge.worlds.geometry import Edge, Point, is_convex, rectangle
from simbridge.worlds.obstacle_settings import PolygonObstacleSettings, WallSettings
from simbridge.worlds.world_settings import WorldSettings

_LEAST_STARTS = 8
_LEAST_CUTS = 2
_TRIES = 40


def room(seed: int) -> WorldSettings:
    """Return the room of a seed, with convex and concave corners and a spur wall to turn back at."""
    name = f"rooms-{seed}"
    attempt = 0
    while True:
        rng = SeededRandom(f"{name}, attempt {attempt}")
        plan = RoomPlan(rng.length_m(3.2, 5.0), rng.length_m(3.2, 4.6))
        if _furnish(plan, rng):
            starts = starts_along_walls(plan.floor, rng)
            if len(starts) >= _LEAST_STARTS:
                break
        attempt += 1
    return WorldSettings(
        name=name,
        size_m=(plan.width_m, plan.height_m),
        infrared_rays=1,
        outline=plan.corners,
        walls=tuple(plan.walls),
        polygon_obstacles=tuple(plan.tables),
        start_poses=starts,
    )


def _furnish(plan: RoomPlan, rng: SeededRandom) -> bool:
    """Cut the outline, add walls and tables; return False if the room is too plain."""
    cuts = 0
    wanted = _LEAST_CUTS + rng.integer(3)
    for _ in range(_TRIES):
        cuts += plan.cut(_cut(plan, rng))
        if cuts == wanted:
            break
    if (
        cuts < _LEAST_CUTS
        or is_convex(plan.corners[:-1])
        or not any(plan.stand(_spur_wall(plan, rng)) for _ in range(_TRIES))
    ):
        return False
    if rng.chance(0.5):
        any(plan.stand(_moved_wall(plan, rng)) for _ in range(_TRIES))
    for i in range(rng.integer(3)):
        any(plan.lay(_table(plan, rng, f"table-{i + 1}")) for _ in range(_TRIES))
    return True


def _cut(plan: RoomPlan, rng: SeededRandom) -> tuple[Point, ...]:
    """Return a rectangular or slanted polygon at a corner or a side."""
    side = rng.integer(4)
    side_m = plan.width_m if side % 2 == 0 else plan.height_m
    long_m, deep_m = rng.length_m(0.5, 1.4), rng.length_m(0.3, 1.1)
    kind = rng.choice(("boxed corner", "slanted corner", "box", "wedge"))
    out_m = 0.1  # beyond the outline, so that no chink stays
    if kind == "boxed corner":
        shape = [(-out_m, -out_m), (long_m, -out_m), (long_m, deep_m), (-out_m, deep_m)]
    elif kind == "slanted corner":
        share = out_m / long_m
        shape = [(-out_m, -out_m), (long_m + out_m, -share * deep_m), (-out_m, deep_m * (1 + share))]
    else:
        begin_m = rng.length_m(0.4, max(0.4, side_m - long_m - 0.4))
        lean_m = 0.0 if kind == "box" else rng.length_m(0.15, 0.6)
        end_m = begin_m + long_m + (0.0 if kind == "box" else rng.length_m(0.15, 0.6))
        shape = [(begin_m, 0.0), (end_m, 0.0), (begin_m + lean_m + 0.6 * long_m, deep_m), (begin_m + lean_m, deep_m)]
        if kind == "box":
            shape = [(begin_m, -out_m), (end_m, -out_m), (end_m, deep_m), (begin_m, deep_m)]
    return tuple(_from_side(plan, side, along_m, in_m) for along_m, in_m in shape)


def _from_side(plan: RoomPlan, side: int, along_m: float, in_m: float) -> Point:
    """Return the point at a distance along a side, counter-clockwise from below, and at a depth into the room."""
    return (
        (along_m, in_m),
        (plan.width_m - in_m, along_m),
        (plan.width_m - along_m, plan.height_m - in_m),
        (in_m, plan.height_m - along_m),
    )[side]


def _spur_wall(plan: RoomPlan, rng: SeededRandom) -> WallSettings:
    """Return a spur wall from the outline into the room."""
    return _leaning(plan, rng, "tongue", rng.length_m(0.8, 1.8))


def _moved_wall(plan: RoomPlan, rng: SeededRandom) -> WallSettings:
    """Return a wall that leans on another, or one shifted off it into the room."""
    wall = _leaning(plan, rng, "moved-wall", rng.length_m(0.5, 1.2))
    if rng.chance(0.5):
        return wall
    return wall.moved(rng.length_m(-1.5, 1.5), rng.length_m(-1.5, 1.5))


def _leaning(plan: RoomPlan, rng: SeededRandom, name: str, length_m: float) -> WallSettings:
    edge = rng.choice(plan.edges(1.2))
    at = _along(edge, (0.25, 0.75), rng)
    inwards_rad = math.atan2(edge[1][1] - edge[0][1], edge[1][0] - edge[0][0]) + math.pi / 2
    inwards_rad += math.radians(rng.choice((0, 0, -15, -10, 10, 15)))
    return WallSettings(
        name=name,
        from_m=_beyond(at, -0.03, inwards_rad),
        to_m=_beyond(at, length_m, inwards_rad),
        thickness_m=rng.length_m(0.06, 0.1),
    )


def _table(plan: RoomPlan, rng: SeededRandom, name: str) -> PolygonObstacleSettings:
    """Return a box at a wall or anywhere."""
    long_m, deep_m = rng.length_m(0.4, 1.0), rng.length_m(0.4, 0.8)
    if rng.chance(0.6):
        edge = rng.choice(plan.edges(0.8))
        heading_rad = math.atan2(edge[1][1] - edge[0][1], edge[1][0] - edge[0][0])
        centre = _beyond(_along(edge, (0.0, 1.0), rng), deep_m / 2 - 0.02, heading_rad + math.pi / 2)
    else:
        heading_rad = math.radians(15 * rng.integer(6))
        centre = rng.length_m(0.0, plan.width_m), rng.length_m(0.0, plan.height_m)
    corners = rectangle(centre, long_m, deep_m, heading_rad)
    return PolygonObstacleSettings(name=name, corners=tuple((round(x, 2), round(y, 2)) for x, y in corners))


def _along(edge: Edge, shares: tuple[float, float], rng: SeededRandom) -> Point:
    (ax, ay), (bx, by) = edge
    share = shares[0] + (shares[1] - shares[0]) * rng.integer(101) / 100
    return ax + share * (bx - ax), ay + share * (by - ay)


def _beyond(at: Point, length_m: float, heading_rad: float) -> Point:
    return round(at[0] + length_m * math.cos(heading_rad), 2), round(at[1] + length_m * math.sin(heading_rad), 2)
