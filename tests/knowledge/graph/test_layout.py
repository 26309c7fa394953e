"""Places of RLAs in the picture of their network."""

import itertools
import math

import networkx as nx
import pytest

from kurt2rt.knowledge.graph.graph import RlaNetwork
from kurt2rt.knowledge.graph.layout import APART, place_groups, place_known, span


def test_place_groups_keeps_groups_together_and_tiles_apart() -> None:
    groups = [list(range(start, start + size)) for start, size in ((0, 25), (100, 7), (200, 7), (300, 1))]
    places = place_groups(groups)
    assert min(math.dist(one, other) for one, other in itertools.combinations(places.values(), 2)) >= 1.0
    for ids in groups:
        (low_x, high_x), (low_y, high_y) = span({each: places[each] for each in ids})
        within = [each for each, (x, y) in places.items() if low_x <= x <= high_x and low_y <= y <= high_y]
        assert within == ids


def test_place_known_places_are_kept() -> None:
    streets: RlaNetwork = nx.DiGraph()
    for rla_id, x_m, y_m in ((1, 0.0, 0.0), (2, 1.8, 0.0), (3, 1.8, 1.8)):
        streets.add_node(rla_id, x_m=x_m, y_m=y_m)
    places = place_known(streets)
    across, up = places[2][0] - places[1][0], places[3][1] - places[2][1]
    assert across == pytest.approx(up, rel=0.01)
    assert across > 2 * APART
    assert places[1][1] == pytest.approx(places[2][1], abs=0.01)
