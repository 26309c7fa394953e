"""Plan: the chain of edges from a place to a goal."""

from collections.abc import Collection
from dataclasses import dataclass
from itertools import pairwise

import networkx as nx

from kurt2rt.core.planning.topological_map import Edge, TopologicalMap


@dataclass(frozen=True, slots=True)
class Plan:
    """Consecutive edges in driving order."""

    edges: tuple[Edge, ...]

    @property
    def ticks(self) -> float:
        """Expected duration in ticks."""
        return sum(edge.ticks for edge in self.edges)

    @property
    def next(self) -> Edge | None:
        """Edge to drive now; None at the goal."""
        return self.edges[0] if self.edges else None

    def after_first(self) -> "Plan":
        """Return the rest of the plan after its first edge; empty after the last edge."""
        return Plan(self.edges[1:])


def plan_to(topological_map: TopologicalMap, start: int, goals: Collection[int]) -> Plan | None:
    """Return the cheapest plan from a place to one of the goals (Dijkstra).

    Returns None if no path exists, or if the map lacks `start`. `start` and `goals`: ids of places.
    """
    if start not in topological_map.graph:
        return None
    costs: dict[int, float]
    paths: dict[int, list[int]]
    costs, paths = nx.single_source_dijkstra(topological_map.graph, start, weight="cost")  # type: ignore[assignment]
    reached = [goal for goal in goals if goal in costs]
    if not reached:
        return None
    path = paths[min(reached, key=lambda goal: (costs[goal], goal))]
    return Plan(tuple(topological_map.edge(*pair) for pair in pairwise(path)))
