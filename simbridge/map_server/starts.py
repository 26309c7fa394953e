"""Start poses found on a map: far from walls, and far from each other."""

import math

import numpy as np
import shapely
from shapely.ops import nearest_points

from simbridge.geometry import polygons_of
from simbridge.pose import Pose

_STARTS = 8
_APART_M = 0.5
_CANDIDATES = 2000
_FAR_M = 0.8
"""Farther from a wall than this is no better: nothing is in sight either way."""


def turning_places(floor: shapely.Polygon, turning_m: float) -> shapely.Polygon | None:
    """The largest area in which a robot that needs this radius can be everywhere; None when it fits nowhere."""
    pieces = polygons_of(shapely.buffer(floor, -turning_m, quad_segs=4))
    return max(pieces, key=lambda piece: float(piece.area), default=None)


def starts_away_from_walls(floor: shapely.Polygon, places: shapely.Polygon) -> list[Pose]:
    """Up to 8 poses in `places`, each with the nearest wall on the left; the same ones on every call."""
    candidates = _lattice(places)
    walls = floor.boundary
    shapely.prepare(walls)
    clear_m = np.minimum(shapely.distance(shapely.points(candidates), walls), _FAR_M)
    chosen = [int(np.argmax(clear_m))]
    apart_m = np.full(len(candidates), np.inf)
    while len(chosen) < _STARTS:
        apart_m = np.minimum(apart_m, np.hypot(*(candidates - candidates[chosen[-1]]).T))
        next_one = int(np.argmax(np.where(apart_m >= _APART_M, apart_m * clear_m, 0.0)))
        if apart_m[next_one] < _APART_M:
            break
        chosen.append(next_one)
    return [_facing_along(walls, float(x), float(y)) for x, y in candidates[chosen]]


def _lattice(places: shapely.Polygon) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    west_m, south_m, east_m, north_m = places.bounds
    step_m = math.sqrt(places.area / _CANDIDATES)
    x, y = np.meshgrid(np.arange(west_m, east_m, step_m), np.arange(south_m, north_m, step_m))
    within = shapely.contains_xy(places, x, y)
    if not within.any():  # narrower than the lattice is wide
        inside = places.representative_point()
        return np.array([[inside.x, inside.y]])
    return np.stack([x[within], y[within]], axis=1)


def _facing_along(walls: shapely.Geometry, x_m: float, y_m: float) -> Pose:
    on_wall, _ = nearest_points(walls, shapely.Point(x_m, y_m))
    return Pose(x_m, y_m, math.atan2(on_wall.y - y_m, on_wall.x - x_m) - math.pi / 2)
