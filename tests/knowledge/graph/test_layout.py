"""Places of RLAs in the picture of their network."""

import itertools
import math

import networkx as nx
import pytest

from kurt2rt.knowledge.graph.graph import RlaNetwork
from kurt2rt.knowledge.graph.layout import APART, Places, compute_layout


def network(*edges: tuple[int, int, float], alone: int = 0) -> RlaNetwork:
    made: RlaNetwork = nx.DiGraph()
    for before, after, percent in edges:
        made.add_edge(before, after, percent=percent)
    made.add_nodes_from(range(1000, 1000 + alone))
    return made


def nearest(places: Places) -> float:
    return min(math.dist(one, other) for one, other in itertools.combinations(places.values(), 2))


def test_compute_layout_dense_network_keeps_distances() -> None:
    dense = network(*((one, other, 5.0) for one in range(20) for other in range(20) if (7 * one + other) % 5 == 0))
    assert nearest(compute_layout(dense)) > 0.95 * APART


def test_compute_layout_known_places_are_kept() -> None:
    streets = network((1, 2, 100.0), (2, 3, 100.0))
    for rla_id, x_m, y_m in ((1, 0.0, 0.0), (2, 1.8, 0.0), (3, 1.8, 1.8)):
        streets.add_node(rla_id, x_m=x_m, y_m=y_m)
    places = compute_layout(streets)
    across, up = places[2][0] - places[1][0], places[3][1] - places[2][1]
    assert across == pytest.approx(up, rel=0.01)
    assert across > 2 * APART
    assert places[1][1] == pytest.approx(places[2][1], abs=0.01)
