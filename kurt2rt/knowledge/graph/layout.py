"""Where the RLAs of a network stand in its picture: those that often follow each other near each other."""

import math

import networkx as nx
import numpy as np
from numpy.typing import NDArray

from kurt2rt.knowledge.graph.graph import RlaNetwork

Places = dict[int, tuple[float, float]]
"""RLA id -> where it stands."""

APART = 1.0
"""No two stand nearer to each other than this."""
_NEAREST = 1.4
"""Between two of which the one always follows the other."""
_BETWEEN = 1.6
"""Between parts that no edge joins."""
_ROOM = 2.5
"""Side of the square that each has on average where RLAs stand at their places."""
_WEAK = 1.2
"""So much farther apart stand RLAs of which the one hardly ever follows the other."""


def compute_layout(network: RlaNetwork) -> Places:
    """Places with at least APART between any two; where the RLAs know where they are, that is it."""
    nodes = network.nodes
    known = {rla_id: (nodes[rla_id]["x_m"], nodes[rla_id]["y_m"]) for rla_id in network if "x_m" in nodes[rla_id]}
    if known and len(known) == len(network):
        return _apart(_in_units(known))
    parts = sorted(nx.weakly_connected_components(network), key=lambda part: (-len(part), min(part)))
    return _packed([_by_neighbourhood(network.subgraph(part)) for part in parts])


def _by_neighbourhood(network: RlaNetwork) -> Places:
    """Distances in the picture like those along edges (Kamada and Kawai 1989)."""
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
    places = _lying(np.array([laid[rla_id] for rla_id in ids]))
    # networkx scales its layout to a square of side 2.
    drawn = np.linalg.norm(places[:, None] - places[None, :], axis=2).sum()
    places *= sum(lengths[one][other] for one in ids for other in ids) / drawn
    return _apart({rla_id: (float(x), float(y)) for rla_id, (x, y) in zip(ids, places, strict=True)})


def _packed(parts: list[Places]) -> Places:
    """The largest part on top, the others in rows beneath it."""
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
    """From where to where they reach, in x and in y."""
    xs, ys = [x for x, _ in places.values()], [y for _, y in places.values()]
    return (min(xs), max(xs)), (min(ys), max(ys))


def _lying(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Turned so that it is wider than high."""
    centred = places - places.mean(axis=0)
    _, _, axes = np.linalg.svd(centred, full_matrices=False)
    turned: NDArray[np.float64] = centred @ axes.T
    return turned


def _in_units(known: Places) -> Places:
    """Metres as units, so many that all have room."""
    (low_x, high_x), (low_y, high_y) = span(known)
    reach = max(high_x - low_x, high_y - low_y)
    unit = _ROOM * math.sqrt(len(known)) / reach if reach > 0 else 1.0
    return {rla_id: (x * unit, y * unit) for rla_id, (x, y) in known.items()}


def _apart(places: Places) -> Places:
    """Those that stand too near to each other are pushed aside, little by little."""
    ids = sorted(places)
    points = np.array([places[rla_id] for rla_id in ids])
    # Several on the very same place get directions of their own.
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
