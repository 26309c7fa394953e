"""Layout of a network in its picture: RLAs that often follow each other are near each other."""

import math

import networkx as nx
import numpy as np
from numpy.typing import NDArray

from kurt2rt.knowledge.graph.graph import RlaNetwork

Places = dict[int, tuple[float, float]]
"""RLA id -> (x, y) in units of the picture."""

APART = 1.0
"""Smallest distance of two RLAs, in units of the picture."""
_NEAREST = 1.4
"""Distance of two RLAs of which the one always follows the other."""
_BETWEEN = 1.6
"""Distance of parts that no edge joins."""
_ROOM = 2.5
"""Side of the square that each RLA has on average in a layout by known places."""
_WEAK = 1.2
"""Relative increase of the distance for RLAs of which the one hardly ever follows the other."""


def compute_layout(network: RlaNetwork) -> Places:
    """Return the place in a drawing of each RLA of a network, by id, at least APART from each other.

    Known places of the RLAs are kept; otherwise the edges make the layout.
    """
    nodes = network.nodes
    known = {rla_id: (nodes[rla_id]["x_m"], nodes[rla_id]["y_m"]) for rla_id in network if "x_m" in nodes[rla_id]}
    if known and len(known) == len(network):
        return _push_apart(_in_units(known))
    parts = sorted(nx.weakly_connected_components(network), key=lambda part: (-len(part), min(part)))
    return _packed([_by_neighbourhood(network.subgraph(part)) for part in parts])


def _by_neighbourhood(network: RlaNetwork) -> Places:
    """Return places whose distances are like those along edges (Kamada and Kawai 1989)."""
    ids = sorted(network)
    if len(ids) < 2:
        return dict.fromkeys(ids, (0.0, 0.0))
    ways: nx.Graph[int] = nx.Graph()
    for before, after in network.edges:
        length = _NEAREST * (1.0 + _WEAK * (1.0 - network.edges[before, after]["percent"] / 100.0))
        if not ways.has_edge(before, after) or ways.edges[before, after]["length"] > length:
            ways.add_edge(before, after, length=length)
    lengths = dict(nx.all_pairs_dijkstra_path_length(ways, weight="length"))
    laid = nx.kamada_kawai_layout(ways, dist=lengths)
    places = _landscape(np.array([laid[rla_id] for rla_id in ids]))
    # networkx scales its layout to a square of side 2.
    drawn = np.linalg.norm(places[:, None] - places[None, :], axis=2).sum()
    places *= sum(lengths[one][other] for one in ids for other in ids) / drawn
    return _push_apart({rla_id: (float(x), float(y)) for rla_id, (x, y) in zip(ids, places, strict=True)})


def _packed(parts: list[Places]) -> Places:
    """Return one layout: the largest part on top, the others in rows beneath it."""
    packed: Places = {}
    width = right = 0.0
    top = bottom = 0.0
    for part in parts:
        (low_x, high_x), (low_y, high_y) = span(part)
        if right > 0 and right + high_x - low_x > width:
            right, top = 0.0, bottom - _BETWEEN
        packed |= {rla_id: (right + x - low_x, top + y - high_y) for rla_id, (x, y) in part.items()}
        right += high_x - low_x + _BETWEEN
        width, bottom = max(width, right - _BETWEEN), min(bottom, top - (high_y - low_y))
    return packed


def span(places: Places) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the extent of a layout, (lowest, highest) of x and of y; it has at least one place."""
    xs, ys = [x for x, _ in places.values()], [y for _, y in places.values()]
    return (min(xs), max(xs)), (min(ys), max(ys))


def _landscape(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the places, shape (n, 2), rotated so that they are wider than high."""
    centred = places - places.mean(axis=0)
    _, _, axes = np.linalg.svd(centred, full_matrices=False)
    turned: NDArray[np.float64] = centred @ axes.T
    return turned


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
