"""Layout of a network in its picture: at known places, or in groups."""

import math
from collections.abc import Sequence

import numpy as np

from kurt2rt.knowledge.graph.graph import RlaNetwork

Place = tuple[float, float]
Places = dict[int, Place]
"""RLA id -> (x, y) in units of the picture."""

APART = 1.25
"""Smallest distance of two RLAs at known places, in sides of a tile: no corner lies on another tile."""
_ROOM = 2.0
"""Side of the square that each RLA has on average in a layout by known places."""
_GAP = 0.7
"""Room between groups."""
_ASPECT = 1.7


def place_known(network: RlaNetwork) -> Places:
    """Return the places that all RLAs of a network have themselves, at least APART from each other; empty without."""
    known = {rla_id: (node["x_m"], node["y_m"]) for rla_id, node in network.nodes.items() if "x_m" in node}
    return _push_apart(_in_units(known)) if known and len(known) == len(network) else {}


def place_groups(groups: Sequence[Sequence[int]]) -> Places:
    """Return the places of the ids of each group, in rows of the group; groups stand in rows of the picture."""
    places: Places = {}
    widest = math.sqrt(1.3 * _ASPECT * sum(map(len, groups))) + 2
    left = top = bottom = 0.0
    for ids in groups:
        wide = math.ceil(math.sqrt(_ASPECT * len(ids)))
        if left and left + wide > widest:
            left, top = 0.0, bottom - _GAP
        places |= {rla_id: (left + at % wide, top - at // wide) for at, rla_id in enumerate(ids)}
        bottom = min(bottom, top - math.ceil(len(ids) / wide))
        left += min(wide, len(ids)) + _GAP
    return places


def span(places: Places) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the extent of a layout, (lowest, highest) of x and of y; it has at least one place."""
    xs, ys = [x for x, _ in places.values()], [y for _, y in places.values()]
    return (min(xs), max(xs)), (min(ys), max(ys))


def _in_units(known: Places) -> Places:
    """Return places in metres scaled to units, so that all RLAs have room."""
    (low_x, high_x), (low_y, high_y) = span(known)
    reach = max(high_x - low_x, high_y - low_y)
    unit = _ROOM * math.sqrt(len(known)) / reach if reach > 0 else 1.0
    return {rla_id: (x * unit, y * unit) for rla_id, (x, y) in known.items()}


def _push_apart(places: Places) -> Places:
    """Push RLAs that are too near to each other apart, step by step."""
    ids = sorted(places)
    points = np.array([places[rla_id] for rla_id in ids])
    # Small noise gives RLAs at one place different directions.
    points = points + 1e-3 * np.random.default_rng(0).normal(size=points.shape)
    for _ in range(200):
        between = points[:, None, :] - points[None, :, :]
        distance = np.maximum(np.linalg.norm(between, axis=2), 1e-9)
        np.fill_diagonal(distance, np.inf)
        lack = np.maximum(APART - distance, 0.0)
        if lack.max() < 1e-3 * APART:
            break
        points += 0.5 * (between / distance[:, :, None] * lack[:, :, None]).sum(axis=1)
    return {rla_id: (float(x), float(y)) for rla_id, (x, y) in zip(ids, points, strict=True)}
