"""Plans on the topological map."""

import networkx as nx
import numpy as np
import pytest

from kurt2rt.core.planning.goal_pursuit import Plan, plan_to
from kurt2rt.core.planning.target import Target, near_target
from kurt2rt.core.planning.topological_map import Edge, Place, TopologicalMap
from tests.core.planning.town import SPACE, Town, ended
from tests.core.rla.helpers import withdrawn


def block() -> Town:
    """Four corners; anticlockwise by left turns, and a short cut from the first to the third."""
    town = Town(sw=(0.0, 0.0), se=(2.0, 0.0), ne=(2.0, 2.0), nw=(0.0, 2.0))
    town.way("sw", "turn_left", "se")
    town.way("se", "turn_left", "ne")
    town.way("ne", "turn_left", "nw")
    town.way("nw", "turn_left", "sw")
    return town


def place_id(town: Town, place: str) -> int:
    return town.group_at(town.at(place))[0].rla_id


def meeting(chart: TopologicalMap, target: Target) -> set[int]:
    return {each for each, place in chart.places.items() if target(np.array(place.condition))}


def plan(town: Town, start: str, end: str) -> Plan | None:
    chart = town.chart()
    target = near_target(tuple(town.at(end).tolist()), SPACE.radius, town.distance, town.group_at)
    return plan_to(chart, place_id(town, start), meeting(chart, target))


def actions(found: Plan | None) -> list[str]:
    assert found is not None
    return [way.action for way in found]


def test_plan_joins_edges_never_driven_in_a_row() -> None:
    found = plan(block(), "se", "sw")
    assert actions(found) == ["turn_left", "turn_left", "turn_left"]


def test_plan_takes_the_quicker_chain() -> None:
    town = block()
    town.way("sw", "straight_on", "ne", ticks=1500.0)
    assert actions(plan(town, "sw", "ne")) == ["straight_on"]
    assert actions(plan(town, "sw", "nw")) == ["straight_on", "turn_left"]


def test_map_follow_ups_replace_distant_expectation() -> None:
    town = block()
    torn = town.way("sw", "straight_on", "ne")
    town.seen[torn] = ended(np.array([1.0, 1.0, 0.0]), 800.0)
    town.follow_ups[torn, place_id(town, "ne")] = 1
    town.follow_ups[torn, place_id(town, "nw")] = 1
    chart, here = town.chart(), place_id(town, "sw")
    ends = {place_id(town, each) for each in ("ne", "nw")}
    ways = [edge for edge in chart.edges_from(here) if edge.end in ends]
    assert {way.rla_id for way in ways} == {torn}
    assert {(way.end, way.share) for way in ways} == {(place_id(town, "ne"), 0.5), (place_id(town, "nw"), 0.5)}


def test_map_withdrawn_rla_is_no_edge() -> None:
    town = block()
    rla_id = place_id(town, "se")
    town.system.apply(withdrawn(rla_id, "turn_left"))
    assert plan_to(town.chart(), place_id(town, "sw"), {place_id(town, "ne")}) is None


@pytest.mark.parametrize("seed", range(5))
def test_plan_is_that_of_networkx_ties_included(seed: int) -> None:
    random, chart = np.random.default_rng(seed), TopologicalMap()
    graph: nx.DiGraph[int] = nx.DiGraph()
    for place in range(12):
        chart.places[place] = Place(place, (), ())
        graph.add_node(place)
    for number, (start, end, ticks) in enumerate(random.integers(1, 12, size=(40, 3)).tolist()):
        edge = Edge(number, "forward", start, end, 0.3, ticks // 3)
        chart.add_edge(edge)
        if not graph.has_edge(start, end) or edge.cost < graph.edges[start, end]["cost"]:
            graph.add_edge(start, end, cost=edge.cost)
    paths = nx.single_source_dijkstra_path(graph, 1, weight="cost")
    for goal in range(12):
        found = plan_to(chart, 1, {goal})
        assert (found is None) == (goal not in paths)
        if found is not None:
            assert [1, *(edge.end for edge in found)] == paths[goal]
