"""Loader of worlds by name or path, with a check that the robot can drive in them."""

from collections.abc import Callable
from pathlib import Path

import shapely

from config.plugins import PluginError, UnknownPluginError
from config.settings import SettingsError, content_of, load_settings, settings_of
from config.settings_files import WORLDS, find_config, plugin_file
from hal.robot_settings import GeometrySettings, RobotSettings, load_robot
from simbridge.contracts.simulation import GENERATED_KINDS, GENERATED_WORLD
from simbridge.worlds.generator.flats import flat
from simbridge.worlds.generator.floors import cluttered_floor
from simbridge.worlds.generator.rooms import room
from simbridge.worlds.generator.streets import streets
from simbridge.worlds.geometry import polygons_of
from simbridge.worlds.world_settings import WorldSettings

START_CLEARANCE_M = 0.05
"""Least wall clearance of a start pose; a robot that turns at a smaller one collides."""

GENERATED = "rooms-N, flats-N, streets-N or floors-N with any whole number N up to 9 digits, such as rooms-17"
"""Valid names of generated worlds, for messages."""
_GENERATORS = dict(zip(GENERATED_KINDS, (room, flat, streets, cluttered_floor), strict=True))

_IMAGES = (".png", ".pgm", ".ppm", ".pbm", ".jpg", ".jpeg", ".bmp", ".gif", ".tif", ".tiff", ".svg")
"""Suffixes of images, which are no worlds."""


def load_world(name_or_path: str = "a", robot: RobotSettings | None = None) -> WorldSettings:
    """Return a world that the robot (KURT2 unless given) can drive in: shipped or generated, by name, or from a file.

    Names: those in config/worlds, and `rooms-17`, `flats-17`, `streets-17` and `floors-17` for any number
    (simbridge.worlds.generator).
    Files: a world, a map of ROS's map_server, or a world on such a map (simbridge.worlds.map_server).
    Plug-ins: the path of such a file, or a function without arguments that returns a world or the content of its file.
    Raises config.settings.SettingsError that names file and key.
    """
    geometry = (robot or load_robot()).geometry
    world = _generated(name_or_path)
    source = name_or_path
    if world is None:
        found = _find(name_or_path)
        if isinstance(found, Path):
            source, world = str(found), _read(found, geometry)
        else:
            world = _made(found, name_or_path)
    require_drivable(world, geometry, source)
    return world


def _made(make: Callable[[], object], name: str) -> WorldSettings:
    """Return the world that the function of a plug-in makes. Raises SettingsError."""
    try:
        world = make()
    except Exception as error:
        told = " ".join(f"{type(error).__name__}: {error}".split())
        raise SettingsError(f"its function raised {told}", where=f"world {name}", do="mend the plug-in") from error
    if isinstance(world, WorldSettings):
        return world
    if not isinstance(world, dict):
        told = f"its function returned a {type(world).__name__}, allowed are WorldSettings or a dict"
        raise SettingsError(told, where=f"world {name}", do="mend the plug-in")
    return settings_of(world, WorldSettings, f"world {name}")


def _read(path: Path, geometry: GeometrySettings) -> WorldSettings:
    """Return the world of a file: a world, a map or a world on a map, by its keys."""
    keys = _keys(path)
    if not keys & {"image", "Image", "map"} or "outline" in keys:
        return load_settings(path, WorldSettings)
    # Imported here: only maps need the image libraries.
    from simbridge.worlds.map_server.world import world_from_map, world_on_map

    return world_on_map(path) if "map" in keys else world_from_map(path, geometry)


def _keys(path: Path) -> set[str]:
    try:
        content = content_of(path)
    except SettingsError:
        return set()  # load_settings reports the error
    return set(content) if isinstance(content, dict) else set()


def _find(name_or_path: str) -> Path | Callable[[], object]:
    """Return the file of a world, or the function of a plug-in that makes it. Raises SettingsError."""
    given = Path(name_or_path)
    if given.suffix.lower() in _IMAGES:
        raise SettingsError(
            "is an image, not a world",
            where=name_or_path,
            do=(
                f"give the YAML file of its map, such as {given.with_suffix('.yaml')} (ROS map_server: "
                "image, resolution, origin, thresholds)"
            ),
        )
    try:
        return find_config("worlds", name_or_path)
    except SettingsError as error:
        return _of_plugin(name_or_path, error)


def _of_plugin(name: str, unknown: SettingsError) -> Path | Callable[[], object]:
    try:
        found = WORLDS.find(name)
    except UnknownPluginError as error:
        offered = "".join(f"{each.name}, " for each in WORLDS.installed())
        raise SettingsError(str(unknown), do=f"or {offered}module:NAME, {GENERATED}") from error
    except PluginError as error:
        raise SettingsError(error.what, where=error.where, do=error.do) from error
    return found if callable(found) else plugin_file(str(found), name)


def require_drivable(world: WorldSettings, geometry: GeometrySettings, source: str) -> None:
    """Check that each start is free and reachable, and that the robot fits into each street.

    Raises SettingsError that names the source and the key.
    """
    clearances_m = world.clearances_m((start.pose for start in world.start_poses), geometry)
    for i, clear_m in enumerate(clearances_m):
        if clear_m < START_CLEARANCE_M:
            raise SettingsError(
                f"start_poses.{i}: the robot is {clear_m:.3f} m from a wall or obstacle, allowed is at least "
                f"{START_CLEARANCE_M} m",
                where=source,
                do="move the pose away from it",
            )
    # Possible positions of the robot's centre: it passes a gap as wide as itself.
    within_reach = world.free_space.buffer(-geometry.outline_width_m / 2)
    pieces = polygons_of(within_reach)
    first = world.start_poses[0]
    home = min(pieces, key=lambda piece: float(piece.distance(shapely.Point(first.x_m, first.y_m))))
    for i, start in enumerate(world.start_poses):
        if not home.intersects(shapely.Point(start.x_m, start.y_m)):
            raise SettingsError(
                f"start_poses.{i}: no way that is {geometry.outline_width_m} m wide leads there from start_poses.0",
                where=source,
                do="open one, or leave the pose out",
            )
    for i, street in enumerate(world.streets):
        if not home.covers(shapely.LineString([street.from_m, street.to_m])):
            raise SettingsError(
                f"streets.{i}: the robot does not fit along its middle line, or cannot get there",
                where=source,
                do="move the line or what stands in its way",
            )


def _generated(name: str) -> WorldSettings | None:
    """Return the generated world of this name, always the same; None if it is no name of a generated world."""
    match = GENERATED_WORLD.fullmatch(name)
    if match is None:
        return None
    return _GENERATORS[match[1]](int(match[2]))
