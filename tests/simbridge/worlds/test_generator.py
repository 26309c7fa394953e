"""Generated worlds: drivable, and equal for equal seeds."""

import hashlib
import itertools
import math

import pytest
import shapely

from config.settings import SettingsError
from simbridge.worlds.generator.starts import FOLLOWING_M, TURNING_M, is_drivable
from simbridge.worlds.world_loading import load_world
from simbridge.worlds.world_settings import WorldSettings
from tests.simbridge.rig import ROBOT, Rig
from tests.simbridge.survey.test_laps import follow, lap_driven


def seeds(quick: range, deep: range) -> list[object]:
    return [pytest.param(quick, id="quick"), pytest.param(deep, id="deep", marks=pytest.mark.deep)]


def generated(name: str) -> WorldSettings:
    return load_world(name, ROBOT)


def digest(name: str) -> str:
    return hashlib.sha256(generated(name).model_dump_json().encode()).hexdigest()[:16]


@pytest.mark.parametrize("some", seeds(range(0, 100, 4), range(1100)))
def test_rooms_let_a_wall_follower_round(some: range) -> None:
    for seed in some:
        world = generated(f"rooms-{seed}")
        floor = world.free_space
        assert is_drivable(floor, FOLLOWING_M), world.name
        centres = floor.buffer(-TURNING_M + 0.002)
        assert len(world.start_poses) >= 8
        for start, pose in enumerate(world.start_poses):
            assert centres.contains(shapely.Point(pose.x_m, pose.y_m)), f"{world.name} start_poses.{start}"
        corners = shapely.Polygon(world.outline)
        assert corners.area < corners.convex_hull.area - 0.05, f"{world.name} has no corner that points inwards"
        assert world.walls[0].name == "tongue"


@pytest.mark.parametrize("some", seeds(range(0, 100, 4), range(1100)))
def test_streets_are_all_drivable(some: range) -> None:
    for seed in some:
        world = generated(f"streets-{seed}")
        floor = world.free_space
        assert is_drivable(floor), world.name
        faces = floor.boundary
        junctions = world.junctions
        assert len(junctions) >= 9
        for street in world.streets:
            assert 0.7 <= street.width_m <= 1.1
            line = shapely.LineString([street.from_m, street.to_m])
            # At its junctions a wider street may cross it, along its blocks its walls are where they should be.
            assert faces.distance(line) == pytest.approx(street.width_m / 2, abs=0.21), world.name
        middles = shapely.MultiLineString([[street.from_m, street.to_m] for street in world.streets])
        for start in world.start_poses:
            assert middles.distance(shapely.Point(start.x_m, start.y_m)) < 1e-9
            assert all(math.dist((start.x_m, start.y_m), junction) > 0.6 for junction in junctions)


@pytest.mark.parametrize("some", seeds(range(0, 100, 16), range(1100)))
def test_floors_have_thin_things_and_room_to_turn(some: range) -> None:
    for seed in some:
        world = generated(f"floors-{seed}")
        centres = world.free_space.buffer(-TURNING_M + 0.002)
        assert isinstance(centres, shapely.Polygon), world.name
        assert len(world.start_poses) >= 6
        for start, pose in enumerate(world.start_poses):
            assert centres.contains(shapely.Point(pose.x_m, pose.y_m)), f"{world.name} start_poses.{start}"
        assert len({*world.names}) == len(world.names) >= 2
        assert all(board.thickness_m == 0.02 for board in world.walls)
        assert all(leg.radius_m <= 0.05 for leg in world.round_obstacles)


@pytest.mark.parametrize("some", seeds(range(0, 100, 16), range(1100)))
def test_floors_leave_no_gap_in_which_a_robot_gets_stuck(some: range) -> None:
    for seed in some:
        world = generated(f"floors-{seed}")
        room = shapely.Polygon(world.outline).exterior
        pieces = pieces_of(world)
        gaps_m = [shapely.distance(one, other) for one, other in itertools.combinations(pieces, 2)]
        gaps_m += [shapely.distance(piece, room) for piece in pieces]
        assert all(gap_m <= 0.2 or gap_m >= 0.7 for gap_m in gaps_m), world.name


def pieces_of(world: WorldSettings) -> list[shapely.Geometry]:
    """Return the area of each piece of furniture; of one on legs the area between them, too."""
    parts: dict[str, list[shapely.Geometry]] = {}
    for name, shape in zip(world.names, world.shapes, strict=True):
        parts.setdefault(name.partition("-leg-")[0], []).append(shape)
    return [shapely.convex_hull(shapely.union_all(each)) for each in parts.values()]


@pytest.mark.parametrize("some", seeds(range(0, 100, 24), range(1100)))
def test_flats_let_the_robot_turn_in_all_rooms(some: range) -> None:
    for seed in some:
        world = generated(f"flats-{seed}")
        floor = world.free_space
        centres = floor.buffer(-TURNING_M, quad_segs=4)
        largest = max(shapely.get_parts(centres), key=shapely.area)
        assert largest.area >= 0.95 * centres.area, world.name
        assert len(world.start_poses) >= 6
        assert all(largest.buffer(0.002).contains(shapely.Point(each.x_m, each.y_m)) for each in world.start_poses)
        # Rooms need walls inside: more than the outer walls and the furniture have.
        assert floor.length - sum(map(shapely.length, world.shapes)) > 1.3 * shapely.box(*floor.bounds).length


def test_generated_worlds_are_equal_on_every_machine() -> None:
    # Numbers of another machine. They change with the generator only: then exams on generated worlds do, too.
    assert [digest("rooms-17"), digest("streets-3")] == ["38d54f9daa54236a", "6635d1be71c0b592"]
    assert digest("floors-17") == "aafca8973228c551"
    corners = [(round(x, 3), round(y, 3)) for x, y in generated("flats-17").outline]
    assert hashlib.sha256(repr(corners).encode()).hexdigest()[:16] == "8811241cf44b5ffa"


def test_generated_worlds_differ_between_seeds() -> None:
    assert len({digest(f"{kind}-{i}") for kind in ("rooms", "flats", "streets", "floors") for i in range(2)}) == 8


def test_is_drivable_rejects_narrow_gaps() -> None:
    room = shapely.box(0, 0, 4, 3)
    assert is_drivable(room)
    assert is_drivable(room.difference(shapely.box(1.9, 0, 2.0, 2.3)))
    assert not is_drivable(room.difference(shapely.box(1.9, 0, 2.0, 2.5)))
    assert not is_drivable(room.difference(shapely.box(0.3, 0.0, 0.4, 1.0)))


@pytest.mark.parametrize("name", ["rooms-", "rooms-017", "rooms-1234567890", "roads-3"])
def test_load_world_unknown_name_lists_the_names(name: str) -> None:
    with pytest.raises(SettingsError, match=rf"^{name}: .* manhattan, .*rooms-N"):
        load_world(name)


@pytest.mark.deep
def test_wall_follower_laps_a_generated_room() -> None:
    world = generated("rooms-0")
    with Rig(world) as rig:
        assert lap_driven(rig, world.start_poses[0].pose) == pytest.approx(1.0, abs=0.02)
        assert rig.robot.collisions == 0


@pytest.mark.deep
def test_wall_follower_laps_nearly_all_rooms() -> None:
    # It may hit the end of a wall between its three front sensors, and turn the wrong way then.
    lapped = 0
    for seed in range(100):
        world = generated(f"rooms-{seed}")
        with Rig(world) as rig:
            rig.robot.place(world.start_poses[0].pose)
            while rig.robot.time_s < 150.0 and rig.robot.laps < 1.0:
                rig.drive(*follow(rig), 0.05)
            lapped += rig.robot.laps >= 1.0
    assert lapped >= 95
