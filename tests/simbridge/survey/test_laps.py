"""Progress along walls, and the rings that it is measured on."""

import itertools
import math
from collections.abc import Iterator

import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from simbridge.contracts.simulation import Pose
from simbridge.robot.world import World
from simbridge.survey.laps import WallProgress
from simbridge.survey.wall_rings import WallRings
from simbridge.worlds.geometry import Point, polygons_of
from simbridge.worlds.world_loading import load_world
from simbridge.worlds.world_settings import WorldSettings
from tests.simbridge.rig import ROBOT, Rig, box, post, room

NAMES = ("a", "b", "c")
FIRST_OF_NAMES = ["a", *(pytest.param(name, marks=pytest.mark.deep) for name in ("b", "c"))]
STEP_M = 0.05
MIDDLE = (2.0, 2.0)


def straight(*corners: Point) -> Iterator[Point]:
    """Yield places on straight lines from corner to corner, as a robot passes them."""
    for a, b in itertools.pairwise(corners):
        steps = max(1, math.ceil(math.dist(a, b) / STEP_M))
        for i in range(1, steps + 1):
            yield a[0] + i / steps * (b[0] - a[0]), a[1] + i / steps * (b[1] - a[1])


def driven(progress: WallProgress, *corners: Point) -> list[float]:
    """Return the laps after each step from corner to corner; the robot is placed at the first."""
    before = progress.laps
    (x_m, y_m), following = corners[0], corners[1]
    progress.reset(Pose(x_m, y_m, math.atan2(following[1] - y_m, following[0] - x_m)))
    laps, last = [0.0], corners[0]
    for place in straight(*corners):
        heading_rad = math.atan2(place[1] - last[1], place[0] - last[0])
        laps.append(progress.update(*place, heading_rad) - before)
        last = place
    return laps


def counted(progress: WallProgress, *corners: Point) -> float:
    """Return the laps made from corner to corner."""
    return driven(progress, *corners)[-1]


def steps_of(laps: list[float]) -> list[float]:
    return [after - before for before, after in itertools.pairwise(laps)]


def outer_ring(world: WorldSettings, position: Point = MIDDLE) -> shapely.LinearRing:
    return WallRings(world, position).rings[0]


ROOM = room()


def test_wall_progress_after_a_moved_wall_is_surveyed_again() -> None:
    world = World(load_world("a"))
    progress, at_wall, position = WallProgress(world), shapely.Point(1.0, 1.9), (0.3, 1.0)
    progress.reset(Pose(*position, 0.0))
    assert outer_ring(world.settings, position).distance(at_wall) < 0.4
    world.move_wall("tongue", 0.8, 0.0)
    progress.update(*position, 0.0)
    assert progress.laps == 0.0
    assert outer_ring(world.settings, position).distance(at_wall) > 0.6


def two_rooms(door_m: float, width_m: float = 0.5) -> WorldSettings:
    """Return two rooms joined by a passage of this length and width, its middle line at y = 2 m."""
    half_m, begin_m, end_m = width_m / 2, 2.0 - door_m / 2, 2.0 + door_m / 2
    south = box((begin_m, 0.0), (end_m, 0.0), (end_m, 2.0 - half_m), (begin_m, 2.0 - half_m), name="south")
    north = box((begin_m, 2.0 + half_m), (end_m, 2.0 + half_m), (end_m, 4.0), (begin_m, 4.0), name="north")
    return room(boxes=[south, north])


@pytest.mark.parametrize("width_m", [0.36, 0.69])
@pytest.mark.parametrize("long_m", [0.06, 1.0])
def test_wall_progress_through_a_passage_is_one_lap(width_m: float, long_m: float) -> None:
    progress = WallProgress(World(two_rooms(long_m, width_m)))
    begin_m, end_m, aside_m = 2.0 - long_m / 2 - 0.3, 2.0 + long_m / 2 + 0.3, width_m / 2 - 0.18
    there = ((0.3, 0.3), (0.3, 3.7), (begin_m, 3.7), (begin_m, 2.0 + aside_m), (end_m, 2.0 + aside_m))
    back = ((end_m, 3.7), (3.7, 3.7), (3.7, 0.3), (end_m, 0.3), (end_m, 2.0 - aside_m), (begin_m, 2.0 - aside_m))
    once = (*there, *back, (begin_m, 0.3), (0.3, 0.3))
    laps = driven(progress, *once, *once[1:])
    assert min(steps_of(laps)) >= 0.0
    assert laps[-1] == pytest.approx(2.0, abs=0.04)
    # With both walls in reach, a robot in the passage has one on its left either way.
    assert -1.02 <= counted(progress, *reversed(once)) < -0.5


@given(
    st.floats(0.34, 1.2),
    st.floats(0.1, 1.4),
    st.lists(st.tuples(st.floats(0.2, 3.8), st.floats(0.2, 3.8), st.floats(0.03, 0.5)), max_size=3),
    st.floats(0.17, 0.5),
)
def test_wall_progress_with_the_wall_on_the_left_is_forward(
    width_m: float, long_m: float, islands: list[tuple[float, float, float]], aside_m: float
) -> None:
    posts = tuple(post(*island, name=f"post-{i}") for i, island in enumerate(islands))
    world = two_rooms(long_m, width_m).model_copy(update={"round_obstacles": posts})
    for part in polygons_of(world.free_space.buffer(-aside_m)):
        progress = WallProgress(World(world))
        # An island is on the left of a robot that goes round it counter-clockwise.
        ways = [(part.exterior, False), *((hole, True) for hole in part.interiors)]
        for way, forward_is_ccw in ways:
            forward = way if way.is_ccw == forward_is_ccw else way.reverse()
            laps = driven(progress, *forward.coords)
            best = itertools.accumulate(laps, max)
            if forward.length > 3.0:  # shorter ways lead round a nook, in which no ring need be
                assert max(most - now for most, now in zip(best, laps, strict=True)) * progress.lap_m <= 0.6
                assert laps[-1] * progress.lap_m >= 0.6 * forward.length


@pytest.mark.parametrize("name", FIRST_OF_NAMES)
def test_wall_follower_laps_each_world_in_time(name: str) -> None:
    world = load_world(name)
    with Rig(world) as rig:
        assert lap_driven(rig, world.start_poses[0].pose) == pytest.approx(1.0, abs=0.02)
        assert rig.robot.collisions == 0


@pytest.mark.deep
@pytest.mark.parametrize("name", NAMES)
def test_driven_lap_counts_one_from_every_start(name: str) -> None:
    world = load_world(name)
    for start in world.start_poses[1:]:
        with Rig(world) as rig:
            rig.robot.place(start.pose)
            assert lap_driven(rig, start.pose) == pytest.approx(1.0, abs=0.02), f"from {start}"


def lap_driven(rig: Rig, start: Pose) -> float:
    """Return the laps counted until the robot, following its wall, crosses the line of its start again."""
    cos, sin = math.cos(start.heading_rad), math.sin(start.heading_rad)
    away, behind = False, False
    while True:
        assert rig.robot.time_s < 110.0, f"{rig.robot.laps:.2f} laps, at {rig.robot.pose}"
        rig.drive(*follow(rig), 0.05)
        dx, dy = rig.robot.pose.x_m - start.x_m, rig.robot.pose.y_m - start.y_m
        ahead_m, left_m = dx * cos + dy * sin, dy * cos - dx * sin
        away = away or math.hypot(dx, dy) > 1.0
        if away and behind and ahead_m >= 0.0 and abs(left_m) < 0.25:
            return rig.robot.laps
        behind = ahead_m < 0.0


def follow(rig: Rig) -> tuple[int, int]:
    """Return wheel speeds in cm/s that follow the wall on the left at 0.2 m."""
    if "ENCODER" not in rig.heard:
        return 0, 0
    ahead_m, front_m, back_m, edge_m = (
        min(ROBOT.infrared.distance_m(rig.reading(name)) for name in group)
        for group in (("s9", "s10", "s11"), ("s1",), ("s2",), ("s15",))
    )
    if ahead_m < 0.24:
        return 15, -15
    if front_m > 0.45:
        return (16, 34) if edge_m < 0.4 else (10, 32)
    turn = 60.0 * (front_m - 0.20) + 120.0 * (front_m - back_m)
    turn = max(-14.0, min(14.0, turn)) if edge_m > 0.22 else -12.0
    return round(30 - turn / 2), round(30 + turn / 2)


def test_laps_of_a_third_of_the_robot_in_a_third_of_the_world() -> None:
    small = WorldSettings.model_validate(
        {
            **ROOM.model_dump(),
            "size_m": tuple(each / 3 for each in ROOM.size_m),
            "outline": tuple((x_m / 3, y_m / 3) for x_m, y_m in ROOM.outline),
            "start_poses": tuple(
                {"x_m": each.x_m / 3, "y_m": each.y_m / 3, "heading_deg": each.heading_deg} for each in ROOM.start_poses
            ),
        }
    )
    corners: list[Point] = [(0.4, 2.0), (0.4, 3.6), (3.6, 3.6), (3.6, 2.0)]
    progress, third = WallProgress(World(ROOM)), WallProgress(World(small), 1 / 3)
    assert third.lap_m == pytest.approx(progress.lap_m / 3)
    small_corners = [(x_m / 3, y_m / 3) for x_m, y_m in corners]
    laps, small_laps = counted(progress, *corners), counted(third, *small_corners)
    assert laps != 0.0
    assert small_laps == pytest.approx(laps, abs=0.02)
