"""Random cluttered floors: tables and chairs on thin legs, lamps, thin boards and boxes in a room."""

import math
from typing import NamedTuple

import shapely

from simbridge.worlds.generator.seeded_random import SeededRandom
from simbridge.worlds.generator.starts import TURNING_M, starts_along_walls
from simbridge.worlds.geometry import Point, polygons_of, rectangle
from simbridge.worlds.obstacle_settings import PolygonObstacleSettings, RoundObstacleSettings, WallSettings
from simbridge.worlds.world_settings import WorldSettings

_BOARD_M = 0.02
"""Thickness of a board: a sensor that looks along it sees nothing else of it."""
_CLOSE_M, _APART_M = 0.2, 0.7
"""Pieces stand closer than the first of these to each other and to walls, or farther apart than the second.

Into a gap of the first the robot does not fit, in one of the second it turns.
"""
_LEAST_STARTS = 6
_TRIES = 150
_KINDS = ("table", "chair", "chair", "board", "board", "leaning board", "lamp", "box")


class _Piece(NamedTuple):
    """Piece of furniture."""

    boards: tuple[WallSettings, ...]
    legs: tuple[RoundObstacleSettings, ...]
    boxes: tuple[PolygonObstacleSettings, ...]

    @property
    def shape(self) -> shapely.Geometry:
        """Area on the floor; of a piece on legs the area between them, too."""
        corners = [*(board.corners for board in self.boards), *(box.corners for box in self.boxes)]
        feet = [shapely.Point(leg.x_m, leg.y_m).buffer(leg.radius_m) for leg in self.legs]
        return shapely.convex_hull(shapely.union_all([*map(shapely.Polygon, corners), *feet]))


def cluttered_floor(seed: int) -> WorldSettings:
    """Return the floor of a seed: a room with one piece of furniture on each 1.2 to 3.5 square metres.

    The density is drawn first, so it differs from floor to floor.
    """
    name = f"floors-{seed}"
    attempt = 0
    while True:
        rng = SeededRandom(f"{name}, attempt {attempt}")
        width_m, height_m = rng.length_m(3.6, 5.4), rng.length_m(3.4, 5.0)
        pieces = _furnish(width_m, height_m, rng)
        floor = _free(width_m, height_m, pieces)
        starts = starts_along_walls(floor, rng)
        if len(polygons_of(floor.buffer(-TURNING_M))) == 1 and len(starts) >= _LEAST_STARTS:
            break
        attempt += 1
    return WorldSettings(
        name=name,
        size_m=(width_m, height_m),
        infrared_rays=3,
        outline=((0.0, 0.0), (width_m, 0.0), (width_m, height_m), (0.0, height_m), (0.0, 0.0)),
        walls=tuple(board for piece in pieces for board in piece.boards),
        round_obstacles=tuple(leg for piece in pieces for leg in piece.legs),
        polygon_obstacles=tuple(box for piece in pieces for box in piece.boxes),
        start_poses=starts,
    )


def _furnish(width_m: float, height_m: float, rng: SeededRandom) -> list[_Piece]:
    """Return pieces of furniture, about half of them at a wall, that leave the robot room to turn between them."""
    wanted = round(width_m * height_m / rng.length_m(1.2, 3.5))
    room = shapely.box(0.0, 0.0, width_m, height_m)
    pieces: list[_Piece] = []
    for _ in range(_TRIES):
        if len(pieces) == wanted:
            break
        kind = rng.choice(_KINDS)
        name = f"{kind.replace(' ', '-')}-{len(pieces) + 1}"
        if kind == "leaning board":
            piece, gaps_m = _leaning_board(name, width_m, height_m, rng), []
        else:
            piece = _piece(kind, name, _place(width_m, height_m, rng), rng)
            gaps_m = [float(shapely.distance(room.exterior, piece.shape))]
        gaps_m += [float(shapely.distance(piece.shape, other.shape)) for other in pieces]
        if room.intersects(piece.shape) and all(0.0 < gap_m <= _CLOSE_M or gap_m >= _APART_M for gap_m in gaps_m):
            pieces.append(piece)
    return pieces


def _free(width_m: float, height_m: float, pieces: list[_Piece]) -> shapely.Polygon:
    """Return the floor without the furniture, in one piece."""
    walls = [board.corners for piece in pieces for board in piece.boards]
    boxes = [box.corners for piece in pieces for box in piece.boxes]
    feet = [shapely.Point(leg.x_m, leg.y_m).buffer(leg.radius_m) for piece in pieces for leg in piece.legs]
    taken = shapely.union_all([*map(shapely.Polygon, (*walls, *boxes)), *feet])
    free = polygons_of(shapely.box(0.0, 0.0, width_m, height_m).difference(taken))
    return max(free, key=lambda piece: float(piece.area))


def _place(width_m: float, height_m: float, rng: SeededRandom) -> tuple[Point, float]:
    """Return the middle of a piece and its heading in rad: along a wall and near it, or anywhere."""
    side = rng.integer(4)
    if rng.chance(0.5):
        along_m = rng.length_m(0.0, width_m if side % 2 == 0 else height_m)
        away_m = rng.length_m(0.1, 0.6)
        middle = ((along_m, away_m), (width_m - away_m, along_m), (along_m, height_m - away_m), (away_m, along_m))[side]
        return middle, math.radians(90 * side)
    return (rng.length_m(0.0, width_m), rng.length_m(0.0, height_m)), math.radians(15 * rng.integer(12))


def _piece(kind: str, name: str, place: tuple[Point, float], rng: SeededRandom) -> _Piece:
    """Return a piece with its middle and heading at this place."""
    centre, heading_rad = place
    if kind == "table":
        corners = rectangle(centre, rng.length_m(0.9, 1.4), rng.length_m(0.65, 0.8), heading_rad)
        return _on_legs(name, corners, rng.length_m(0.02, 0.03))
    if kind == "chair":
        corners = rectangle(centre, rng.length_m(0.32, 0.38), rng.length_m(0.32, 0.38), heading_rad)
        return _on_legs(name, corners, rng.length_m(0.01, 0.02))
    if kind == "lamp":
        return _on_legs(name, (centre,), rng.length_m(0.02, 0.05))
    if kind == "box":
        corners = rectangle(centre, rng.length_m(0.3, 0.6), rng.length_m(0.2, 0.4), heading_rad)
        return _Piece((), (), (PolygonObstacleSettings(name=name, corners=_rounded(corners)),))
    half_m = rng.length_m(0.15, 0.45)
    return _board(name, _beyond(centre, -half_m, heading_rad), _beyond(centre, half_m, heading_rad))


def _leaning_board(name: str, width_m: float, height_m: float, rng: SeededRandom) -> _Piece:
    """Return a board that sticks out of a wall into the room."""
    side = rng.integer(4)
    along_m = rng.length_m(_APART_M, (width_m if side % 2 == 0 else height_m) - _APART_M)
    foot = ((along_m, 0.0), (width_m, along_m), (along_m, height_m), (0.0, along_m))[side]
    inwards_rad = math.radians(90 * (side + 1) + rng.choice((0, 0, -20, 20)))
    return _board(name, _beyond(foot, -0.03, inwards_rad), _beyond(foot, rng.length_m(0.25, 0.7), inwards_rad))


def _board(name: str, begin: Point, end: Point) -> _Piece:
    return _Piece((WallSettings(name=name, from_m=begin, to_m=end, thickness_m=_BOARD_M),), (), ())


def _on_legs(name: str, places: tuple[Point, ...], radius_m: float) -> _Piece:
    """Return a piece with a round leg at each of these places."""
    legs = enumerate(_rounded(places), start=1)
    return _Piece(
        (),
        tuple(RoundObstacleSettings(name=f"{name}-leg-{i}", x_m=x, y_m=y, radius_m=radius_m) for i, (x, y) in legs),
        (),
    )


def _rounded(places: tuple[Point, ...]) -> tuple[Point, ...]:
    return tuple((round(x, 2), round(y, 2)) for x, y in places)


def _beyond(at: Point, length_m: float, heading_rad: float) -> Point:
    return round(at[0] + length_m * math.cos(heading_rad), 2), round(at[1] + length_m * math.sin(heading_rad), 2)
