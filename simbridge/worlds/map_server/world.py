"""Worlds from maps: the room of the start poses, with its islands as obstacles."""

import math
import warnings
from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
import shapely
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError
from pydantic import AliasChoices, ConfigDict, Field, ValidationError, model_validator
from shapely.affinity import scale, translate

from config.settings import Settings, SettingsError, load_settings
from hal.numerics import cos_sin
from hal.robot_settings import GeometrySettings
from simbridge.contracts.simulation import Pose
from simbridge.worlds.map_server.starts import starts_beside_walls, turning_places
from simbridge.worlds.map_server.tracing import TooRaggedError, trace
from simbridge.worlds.obstacle_settings import PolygonObstacleSettings
from simbridge.worlds.world_settings import StartPoseSettings, WorldSettings

Share = Annotated[float, Field(ge=0, le=1)]


class MapSettings(Settings):
    """Schema of the YAML file of a map by map_server; keys of other programs are allowed."""

    model_config = ConfigDict(extra="ignore")

    image: Annotated[str, Field(validation_alias=AliasChoices("image", "Image"))]
    """PGM or PNG file, relative to the YAML file."""
    resolution: Annotated[float, Field(gt=0, le=1)]
    """Metres per cell."""
    origin: tuple[float, float, float]
    """Position in m and counter-clockwise rotation in rad of the image's lower left corner."""
    negate: bool | Literal[0, 1]
    """0 if dark cells are occupied, 1 if bright ones are."""
    occupied_thresh: Share
    free_thresh: Share
    mode: Literal["trinary", "scale", "raw"] = "trinary"

    @model_validator(mode="after")
    def _has_room_between_its_thresholds(self) -> Self:
        if self.free_thresh >= self.occupied_thresh:
            raise ValueError(
                f"free_thresh must be below occupied_thresh (got {self.free_thresh}, allowed < {self.occupied_thresh})"
            )
        return self


def image_error(source: Path, what: str, do: str) -> SettingsError:
    """Return the error that refuses a map's image: `what` is wrong, and what to `do`."""
    return SettingsError(what, where=f"{source}: image", do=do)


class MapWorldSettings(Settings):
    """Schema of a world's file that names a map of map_server, and start poses in the map's frame."""

    map: str
    """YAML file of the map, relative to this file."""
    infrared_rays: Literal[1, 3] | None = None
    """Rays per sensor; by default 3 if something on the map is thinner than the gap between two sensors."""
    start_poses: Annotated[tuple[StartPoseSettings, ...], Field(min_length=1)]


MOST_WALLS = 5000
_MOST_M = 200.0
_THIN_M = 0.09
"""Gap between two side sensors; with one ray per sensor the legs of a chair would often be missed."""
_SLIP_M = 0.06
"""Extra room for turning."""
_SHRINK = "clean the map of specks, or crop it to the robot's area"


MOST_CELLS = 4096 * 4096

_UNKNOWN = -1.0
_SAVED_AS_UNKNOWN = 205
"""Shade of unknown cells in a map that map_saver wrote."""
_HALF_OCCUPIED = 50.0
"""Threshold on an occupancy grid's scale of 0 to 100; mode trinary has nothing between."""


def drivable_cells(source: Path, settings: MapSettings) -> NDArray[np.bool_]:
    """Return the cells of a map's image known to be free, shape (rows, columns), row 0 at the bottom.

    `source`: file of the map, whose `settings` name the image. Raises SettingsError that names file and key.
    """
    image = source.parent / settings.image
    if image.exists() and not image.is_file():  # opening a FIFO waits until another program writes to it
        raise image_error(source, f"{image} is a folder or device, not a file", "give a PGM or PNG file")
    try:
        with warnings.catch_warnings():
            # Pillow warns of huge images, of which nothing is read before the size check below.
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            opened = Image.open(image)
        with opened:
            width, height = opened.size
            if width * height > MOST_CELLS:
                too_large = f"{image} is too large (got {width} x {height} cells, allowed {MOST_CELLS})"
                raise image_error(source, too_large, "crop it to the robot's area")
            shade, opacity = _shades(opened)
    except FileNotFoundError as error:
        raise image_error(source, f"{image} does not exist", "give a path relative to the YAML file") from error
    except (OSError, SyntaxError, ValueError, UnidentifiedImageError, Image.DecompressionBombError) as error:
        if isinstance(error, SettingsError):
            raise
        raise image_error(source, f"{image} cannot be read ({error})", "give a PGM or PNG file") from error
    occupancy = _occupancy(shade, opacity, settings)
    return np.asarray((occupancy >= 0) & (occupancy < _HALF_OCCUPIED))[::-1]


def _shades(image: Image.Image) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    """Return brightness (mean of the colours) and opacity of each cell, 0 to 255; None for an image without opacity."""
    if image.has_transparency_data:
        image = image.convert("RGBA")
    elif image.mode not in ("L", "RGB", "I", "I;16"):
        image = image.convert("RGB" if image.mode == "P" else "L")
    values = np.asarray(image, dtype=np.float64)
    if image.mode in ("I", "I;16"):  # 16 bits
        values = values / 257.0
    if values.ndim == 2:
        return values, None
    return values[..., :3].mean(axis=2), values[..., 3] if image.mode == "RGBA" else None


def _occupancy(
    shade: NDArray[np.float64], opacity: NDArray[np.float64] | None, settings: MapSettings
) -> NDArray[np.float64]:
    """Return map_server's occupancy: 0 free, 100 occupied, -1 unknown.

    In two cases it knows less than map_server. Its map_saver writes unknown as the shade 205, which its own default
    free_thresh of 0.25 takes for free. Invisible cells are free there if their colour is bright enough.
    """
    # As map_server has it, opacity counts as a fourth colour in mode trinary.
    averaged = shade if opacity is None or settings.mode != "trinary" else (3.0 * shade + opacity) / 4.0
    bright = 255.0 - averaged if settings.negate else averaged
    share = (255.0 - bright) / 255.0
    low, high = settings.free_thresh, settings.occupied_thresh
    known: NDArray[np.bool_] | bool = True
    if settings.mode == "raw":
        occupancy = np.where(bright <= 100, bright, _UNKNOWN)
    else:
        between = _UNKNOWN if settings.mode == "trinary" else 1.0 + 98.0 * (share - low) / (high - low)
        occupancy = np.where(share > high, 100.0, np.where(share < low, 0.0, between))
    if settings.mode == "trinary":
        known = (255.0 - shade if settings.negate else shade) != _SAVED_AS_UNKNOWN
    if opacity is not None:
        known = known & (opacity == 255 if settings.mode == "scale" else opacity > 0)
    return np.where(known, occupancy, _UNKNOWN)


def world_from_map(source: Path, geometry: GeometrySettings) -> WorldSettings:
    """Return the world of a map, with start poses next to a wall on the left.

    Raises SettingsError that names file and key.
    """
    floors = _floors(source, load_settings(source, MapSettings))
    # Few floors have room for a robot; the largest come first, until no other one can have more room.
    turning_m = math.hypot(geometry.outline_length_m, geometry.outline_width_m) / 2 + _SLIP_M
    best: tuple[float, shapely.Polygon, shapely.Polygon] | None = None
    searched_walls = 0
    for floor in floors:
        if best is not None and floor.area <= best[0]:
            break
        # Checked before the search for room, which takes half a minute for 30 000 pieces of specks.
        walls = _walls_of(floor)
        if best is not None and searched_walls + walls > MOST_WALLS:
            continue
        _require_few_walls(source, searched_walls + walls)
        places = turning_places(floor, turning_m)
        if places is None:
            searched_walls += walls
        elif best is None or places.area > best[0]:
            best = places.area, floor, places
    if best is None:
        raise image_error(
            source,
            f"no free space for the robot, which needs {2 * turning_m:.2f} m to turn",
            "check resolution, negate, the thresholds and mode",
        )
    return world_of_floor(source, best[1], starts_beside_walls(best[1], best[2]))


def world_on_map(source: Path) -> WorldSettings:
    """Return the world of a file with a map and start poses in the map's frame. Raises SettingsError."""
    chosen = load_settings(source, MapWorldSettings)
    map_source = source.parent / chosen.map
    if not map_source.is_file():
        raise SettingsError(f"map: {map_source} does not exist", where=source, do="give a path relative to this file")
    settings = load_settings(map_source, MapSettings)
    starts = [_on_grid(start.pose, settings) for start in chosen.start_poses]
    first = shapely.Point(starts[0].x_m, starts[0].y_m)
    floor = min(_floors(map_source, settings), key=lambda each: float(each.distance(first)), default=None)
    if floor is None:
        raise image_error(map_source, "no cell is free", "check negate and the thresholds")
    _require_few_walls(map_source, _walls_of(floor))
    return world_of_floor(source, floor, starts, chosen.infrared_rays)


def _floors(source: Path, settings: MapSettings) -> list[shapely.Polygon]:
    """Return the free areas in m from the lower left corner of the image, the largest first."""
    try:
        return floors_of_cells(drivable_cells(source, settings), settings.resolution)
    except TooRaggedError as error:
        raise image_error(source, str(error), f"{_SHRINK}; check the thresholds") from error


def floors_of_cells(cells: NDArray[np.bool_], cell_m: float) -> list[shapely.Polygon]:
    """Return the free areas of cells in m from the lower left corner, the largest first.

    `cells`: whether each is free, (rows, columns), row 0 at the bottom. `cell_m`: their length. Raises TooRaggedError.
    """
    floors = [scale(each, cell_m, cell_m, origin=(0, 0)) for each in trace(cells)]
    return sorted(floors, key=lambda each: float(each.area), reverse=True)


def _walls_of(floor: shapely.Polygon) -> int:
    return len(shapely.get_coordinates(floor)) - 1 - len(floor.interiors)


def _require_few_walls(source: Path, walls: int) -> None:
    if walls > MOST_WALLS:
        raise image_error(source, f"too many pieces of walls (got {walls}, allowed {MOST_WALLS})", _SHRINK)


def _on_grid(start: Pose, settings: MapSettings) -> Pose:
    """Return the pose relative to the lower left corner of the image, along its edges."""
    x_m, y_m, turned_rad = settings.origin
    dx, dy = start.x_m - x_m, start.y_m - y_m
    cos, sin = cos_sin(turned_rad)
    return Pose(dx * cos + dy * sin, dy * cos - dx * sin, start.heading_rad - turned_rad)


def world_of_floor(
    source: Path, floor: shapely.Polygon, starts: list[Pose], infrared_rays: Literal[1, 3] | None = None
) -> WorldSettings:
    """Return the world of a floor with its islands, named as the source.

    `infrared_rays`: for each sensor; None: as many as the thinnest island needs. Raises SettingsError.
    """
    west_m, south_m, east_m, north_m = floor.bounds
    width_m, height_m = east_m - west_m, north_m - south_m
    if max(width_m, height_m) > _MOST_M:
        raise SettingsError(
            f"the free space is too large (got {width_m:.0f} m x {height_m:.0f} m, allowed {_MOST_M:.0f} m)",
            where=f"{source}: resolution",
            do="crop the map to the robot's area",
        )
    shifted = translate(floor, -west_m, -south_m)
    try:
        return WorldSettings(
            name=source.stem,
            size_m=(width_m, height_m),
            infrared_rays=infrared_rays or _rays_for(floor),
            outline=_corners(shifted.exterior),
            polygon_obstacles=tuple(
                PolygonObstacleSettings(name=f"island-{i}", corners=_corners(ring)[:-1])
                for i, ring in enumerate(shifted.interiors, start=1)
            ),
            start_poses=tuple(
                StartPoseSettings(
                    x_m=start.x_m - west_m,
                    y_m=start.y_m - south_m,
                    heading_deg=round(math.degrees(math.remainder(start.heading_rad, 2 * math.pi)), 9),
                )
                for start in starts
            ),
        )
    except ValidationError as error:
        key = ".".join(str(part) for part in error.errors()[0]["loc"]) or "(whole file)"
        raise SettingsError(f"{key}: {error.errors()[0]['msg']}", where=source) from error


def _rays_for(floor: shapely.Polygon) -> Literal[1, 3]:
    boxes = [ring.bounds for ring in floor.interiors]
    thin = any(min(east_m - west_m, north_m - south_m) < _THIN_M for west_m, south_m, east_m, north_m in boxes)
    return 3 if thin else 1


def _corners(ring: shapely.LinearRing) -> tuple[tuple[float, float], ...]:
    return tuple((float(x), float(y)) for x, y in ring.coords)
