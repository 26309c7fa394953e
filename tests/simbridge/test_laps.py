import itertools
import math
import random
from collections.abc import Iterator

import pytest
import shapely

from simbridge.geometry import Point
from simbridge.laps import Laps, way_round
from simbridge.obstacle_settings import PolygonObstacleSettings, WallSettings
from simbridge.pose import Pose
from simbridge.world import World
from simbridge.world_settings import load_world
from tests.simbridge.rig import ROBOT, Rig, room

NAMES = ("a", "b", "c")
FIRST_OF_NAMES = ["a", *(pytest.param(name, marks=pytest.mark.deep) for name in ("b", "c"))]
STEP_M = 0.05
MIDDLE = (2.0, 2.0)
DIVIDER = WallSettings(name="divider", from_m=(3.0, 0.0), to_m=(3.0, 4.0), thickness_m=0.02)


def straight(*corners: Point) -> Iterator[Point]:
    """Places along straight ways from corner to corner, as a robot passes them."""
    for a, b in itertools.pairwise(corners):
        steps = max(1, math.ceil(math.dist(a, b) / STEP_M))
        for i in range(1, steps + 1):
            yield a[0] + i / steps * (b[0] - a[0]), a[1] + i / steps * (b[1] - a[1])


def counted(laps: Laps, *corners: Point) -> float:
    """Laps counted on straight ways from corner to corner, after the robot was put at the first."""
    before = laps.count
    laps.put(corners[0])
    for place in straight(*corners):
        laps.follow(place)
    return laps.count - before


@pytest.mark.parametrize("name", FIRST_OF_NAMES)
@pytest.mark.parametrize("aside_m", [0.1, 0.0, -0.05])
def test_one_way_along_the_wall_is_one_lap_from_every_start(name: str, aside_m: float) -> None:
    world = World(load_world(name))
    laps = Laps(world)
    start = world.settings.start_poses[0]
    way = shapely.Polygon(way_round(world.settings, (start.x_m, start.y_m))).buffer(aside_m).exterior
    way = way.reverse() if way.is_ccw else way
    for start in world.settings.start_poses:
        begin_m = way.project(shapely.Point(start.x_m, start.y_m))
        places = [way.interpolate((begin_m + share * way.length) % way.length) for share in (i / 40 for i in range(41))]
        assert counted(laps, *((place.x, place.y) for place in places)) == pytest.approx(1.0, abs=0.02)


def test_the_other_way_round_counts_backward() -> None:
    laps = Laps(World(room()))
    corners = ((0.3, 2.0), (0.3, 0.3), (3.7, 0.3), (3.7, 3.7), (0.3, 3.7), (0.3, 2.0))
    assert counted(laps, *corners) == pytest.approx(-1.0)
    assert counted(laps, *corners, *corners[1:]) == pytest.approx(-2.0)


def test_circles_in_the_middle_count_nothing() -> None:
    laps = Laps(World(room()))
    for radius_m in (0.1, 0.5, 1.3):
        circle = [(2.0 - radius_m * math.cos(i / 8), 2.0 + radius_m * math.sin(i / 8)) for i in range(200)]
        assert counted(laps, (0.4, 2.0), *circle, (0.4, 2.0)) == pytest.approx(0.0, abs=1e-9)


def test_going_to_and_fro_between_two_walls_is_no_lap() -> None:
    laps = Laps(World(room()))
    # A bit farther round each time, so that now the one and now the other way round is the shorter.
    bounces = [(0.3 if i % 2 else 3.7, 2.0 + 0.3 * math.sin(i)) for i in range(60)]
    assert -1.0 <= counted(laps, *bounces) <= 0.1


@pytest.mark.parametrize("name", FIRST_OF_NAMES)
def test_aimless_ways_through_the_middle_add_up_to_no_laps(name: str) -> None:
    world = World(load_world(name))
    start = world.settings.start_poses[0]
    at = (start.x_m, start.y_m)
    room = shapely.Polygon(way_round(world.settings, at)).buffer(0.15)
    west_m, south_m, east_m, north_m = room.bounds
    laps, dice, legs = Laps(world), random.Random(1), 0
    laps.put(at)
    while legs < 150:
        to = (dice.uniform(west_m, east_m), dice.uniform(south_m, north_m))
        if room.contains(shapely.LineString([at, to])):
            for place in straight(at, to):
                laps.follow(place)
            at, legs = to, legs + 1
            assert -2.0 < laps.count < 1.0


def test_a_lap_with_a_part_left_out_is_none() -> None:
    laps = Laps(World(room()))
    shortcut = ((0.3, 0.3), (0.3, 3.7), (3.7, 3.7), (0.3, 0.3))
    assert counted(laps, *shortcut, *shortcut[1:], *shortcut[1:]) < 0.6


def test_laps_go_on_after_a_trip_through_the_middle() -> None:
    laps = Laps(World(room()))
    once = ((0.3, 2.0), (0.3, 3.7), (3.7, 3.7), (3.7, 0.3), (0.3, 0.3), (0.3, 2.0))
    assert counted(laps, *once, (3.7, 2.1), (0.3, 2.0), *once[1:]) == pytest.approx(2.0, abs=0.02)


def test_put_in_the_middle_it_begins_where_it_comes_to_the_wall() -> None:
    laps = Laps(World(room()))
    once = ((2.0, 3.7), (3.7, 3.7), (3.7, 0.3), (0.3, 0.3), (0.3, 3.7), (2.0, 3.7))
    assert counted(laps, (2.1, 1.9), *once) == pytest.approx(1.0, abs=0.02)


def test_a_wall_against_the_outline_is_gone_round_and_an_island_is_not() -> None:
    board = WallSettings(name="board", from_m=(0.0, 2.5), to_m=(1.5, 2.5), thickness_m=0.1)
    box = PolygonObstacleSettings(name="box", corners=((3.0, 0.0), (4.0, 0.0), (4.0, 1.0), (3.0, 1.0)))
    island = PolygonObstacleSettings(name="island", corners=((1.9, 1.4), (2.2, 1.4), (2.0, 1.6)))
    empty = way_round(room(), MIDDLE)
    assert empty.length == pytest.approx(4 * (4.0 - 2 * 0.35))
    assert way_round(room(boxes=[island]), MIDDLE).equals(empty)
    way = way_round(room(walls=[board], boxes=[box, island]), MIDDLE)
    assert not way.is_ccw
    assert way.distance(shapely.Point(1.5, 2.5)) == pytest.approx(0.35, abs=0.03)
    assert way.distance(shapely.Point(3.0, 1.0)) == pytest.approx(0.35, abs=0.03)
    assert way.distance(shapely.Point(2.0, 1.5)) > 0.5


def test_a_gap_too_narrow_for_the_robot_is_wall() -> None:
    board = WallSettings(name="board", from_m=(0.2, 2.5), to_m=(1.5, 2.5), thickness_m=0.1)
    beside = shapely.Point(1.0, 2.5)
    assert way_round(room(walls=[board]), MIDDLE).distance(beside) < 0.5
    assert way_round(room(walls=[board.moved(0.6, 0.0)]), MIDDLE).distance(beside) > 0.6


def test_of_a_divided_room_it_counts_the_part_that_the_robot_is_in() -> None:
    laps = Laps(World(room(walls=[DIVIDER])))
    corners = ((3.3, 0.3), (3.3, 3.7), (3.7, 3.7), (3.7, 0.3), (3.3, 0.3))
    assert counted(laps, *corners) == pytest.approx(1.0)
    corners = ((0.3, 0.3), (0.3, 3.7), (2.6, 3.7), (2.6, 0.3), (0.3, 0.3))
    assert counted(laps, *corners) == pytest.approx(1.0)


def test_a_narrow_door_leads_to_the_room_behind_it() -> None:
    north = WallSettings(name="north", from_m=(2.0, 4.0), to_m=(2.0, 2.3), thickness_m=0.02)
    south = WallSettings(name="south", from_m=(2.0, 0.0), to_m=(2.0, 1.8), thickness_m=0.02)
    laps = Laps(World(room(walls=[north, south])))
    corners = ((0.3, 0.3), (0.3, 3.7), (1.7, 3.7), (1.7, 2.05), (2.3, 2.05), (2.3, 3.7), (3.7, 3.7), (3.7, 0.3))
    back = ((2.3, 0.3), (2.3, 2.05), (1.7, 2.05), (1.7, 0.3), (0.3, 0.3))
    assert counted(laps, *corners, *back) == pytest.approx(1.0)


def test_swaying_in_a_narrow_corridor_costs_no_lap() -> None:
    wall = WallSettings(name="wall", from_m=(0.8, 0.0), to_m=(0.8, 3.2), thickness_m=0.02)
    laps = Laps(World(room(walls=[wall])))
    there = [(0.3 + (0.25 if i % 3 == 2 else 0.0), 0.3 + 0.3 * i) for i in range(12)]
    back = ((0.8, 3.6), (3.6, 3.6), (3.6, 0.4), (1.2, 0.4), (1.2, 3.4), (0.5, 3.4), (0.5, 0.3), (0.3, 0.3))
    assert counted(laps, *there, *back) == pytest.approx(1.0, abs=0.02)


def test_a_wall_moved_away_takes_its_detour_along() -> None:
    world = World(load_world("a"))
    laps = Laps(world)
    beside_tongue = shapely.Point(1.0, 1.9)
    laps.put((0.3, 1.0))
    assert way_round(world.settings, (0.3, 1.0)).distance(beside_tongue) < 0.4
    world.move_wall("tongue", 0.8, 0.0)
    laps.follow((0.3, 1.0))
    assert laps.count == 0.0
    assert way_round(world.settings, (0.3, 1.0)).distance(beside_tongue) > 0.6


def test_putting_the_robot_down_adds_no_lap() -> None:
    with Rig(load_world("a")) as rig:
        for start in load_world("a").start_poses * 3:
            rig.robot.place(start.pose)
            rig.run(0.2)
        assert rig.robot.laps == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("name", FIRST_OF_NAMES)
def test_a_plain_wall_follower_laps_each_world_in_time(name: str) -> None:
    world = load_world(name)
    with Rig(world) as rig:
        assert lap_driven(rig, world.start_poses[0].pose) == pytest.approx(1.0, abs=0.02)
        assert rig.robot.collisions == 0


@pytest.mark.deep
@pytest.mark.parametrize("name", NAMES)
def test_a_lap_really_driven_counts_one_from_every_start(name: str) -> None:
    world = load_world(name)
    for start in world.start_poses[1:]:
        with Rig(world) as rig:
            rig.robot.place(start.pose)
            assert lap_driven(rig, start.pose) == pytest.approx(1.0, abs=0.02), f"from {start}"


def lap_driven(rig: Rig, start: Pose) -> float:
    """Laps counted until the robot, following its wall, drives again over a line across its start."""
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
    """Wall on the left at 0.2 m: ahead blocked, spin right; wall lost, curve left; else keep the distance."""
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
