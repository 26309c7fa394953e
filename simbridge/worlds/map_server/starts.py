"""Start poses on a map: along a wall on the left, and far from each other."""

import math

import numpy as np
import shapely
from numpy.typing import NDArray

from simbridge.contracts.simulation import Pose
from simbridge.worlds.geometry import polygons_of

_STARTS = 8
_APART_M = 0.5
_STEP_M = 0.1
"""Least distance between two candidates."""
_CANDIDATES = 2000
_ROOM_M = 0.03
"""Extra distance from the wall beyond the turning radius."""
_SENSOR_M = 0.14
"""Distance from the robot's centre to its front and rear side sensors, along its heading."""
_IN_SIGHT_M = 0.45
"""Distance from the robot's centre to a wall that its side sensors see well: 0.285 m from the sensors."""

Points = NDArray[np.float64]


def turning_places(floor: shapely.Polygon, turning_m: float) -> shapely.Polygon | None:
    """Return the largest area in which a robot's centre can be and turn; None if it fits nowhere.

    `turning_m`: radius of the robot's turn on the spot.
    """
    pieces = polygons_of(shapely.buffer(floor, -turning_m, quad_segs=4))
    return max(pieces, key=lambda piece: float(piece.area), default=None)


def starts_beside_walls(floor: shapely.Polygon, places: shapely.Polygon) -> list[Pose]:
    """Return up to 8 poses in `places`, each parallel to a wall on its left; the same poses on every call.

    The side sensors see that wall. On a floor without such a place, the poses are merely near walls.
    """
    walls = floor.boundary
    shapely.prepare(walls)
    candidates = _beside(places)
    feet = _closest_points(walls, candidates)
    headings_rad = np.arctan2(feet[:, 1] - candidates[:, 1], feet[:, 0] - candidates[:, 0]) - math.pi / 2
    seen = _see_their_wall(walls, candidates, headings_rad)
    if seen.any():
        candidates, headings_rad = candidates[seen], headings_rad[seen]
    chosen = _spread(candidates)
    return [Pose(*map(float, (*candidates[each], headings_rad[each]))) for each in chosen]


def _beside(places: shapely.Polygon) -> Points:
    """Return positions along all walls, (n, 2)."""
    inside = places.buffer(-_ROOM_M, quad_segs=4)
    lines = (places if inside.is_empty else inside).boundary
    step_m = max(_STEP_M, lines.length / _CANDIDATES)
    rings = [ring for ring in shapely.get_parts(lines) if ring.length > 0.0]
    return np.concatenate(
        [shapely.get_coordinates(shapely.line_interpolate_point(r, np.arange(0.0, r.length, step_m))) for r in rings]
    )


def _closest_points(walls: shapely.Geometry, positions: Points) -> Points:
    return shapely.get_coordinates(shapely.shortest_line(shapely.points(positions), walls))[1::2]


def _see_their_wall(walls: shapely.Geometry, positions: Points, headings_rad: Points) -> NDArray[np.bool_]:
    """Return whether the wall on the left is close to the front and the rear side sensor."""
    ahead = _SENSOR_M * np.column_stack([np.cos(headings_rad), np.sin(headings_rad)])
    left = _IN_SIGHT_M * np.column_stack([-np.sin(headings_rad), np.cos(headings_rad)])
    seen = np.ones(len(positions), dtype=bool)
    for sensors in (positions + ahead, positions - ahead):
        rays = shapely.linestrings(np.stack([sensors, sensors + left], axis=1))
        seen &= shapely.intersects(walls, rays)
    return seen


def _spread(candidates: Points) -> list[int]:
    """Return indices of candidates far from each other, the one closest to the middle of all first."""
    chosen = [int(np.argmin(_distances_m(candidates, candidates.mean(axis=0))))]
    apart_m = np.full(len(candidates), np.inf)
    while len(chosen) < _STARTS:
        apart_m = np.minimum(apart_m, _distances_m(candidates, candidates[chosen[-1]]))
        next_one = int(np.argmax(apart_m))
        if apart_m[next_one] < _APART_M:
            break
        chosen.append(next_one)
    return chosen


def _distances_m(positions: Points, place: Points) -> Points:
    """Return the distance in m of each position (n, 2) from a place (2,), shape (n,), equal on every processor."""
    distances_m: Points = np.sqrt(np.square(positions - place).sum(axis=1))
    return distances_m
