"""A plan: the chain of RLAs from a place to a goal."""

from collections.abc import Collection
from dataclasses import dataclass
from itertools import pairwise

import networkx as nx

from kurt2rt.core.planning.topological_map import Edge, TopologicalMap


@dataclass(frozen=True, slots=True)
class Plan:
    """Ways that follow each other, in the order of driving."""

    edges: tuple[Edge, ...]

    @property
    def ticks(self) -> float:
        """How long it is expected to take."""
        return sum(way.ticks for way in self.edges)

    @property
    def next(self) -> Edge | None:
        """The way to go now; None at the goal."""
        return self.edges[0] if self.edges else None

    def after_first(self) -> "Plan":
        """What is left of it where its first way leads."""
        return Plan(self.edges[1:])


def plan_to(chart: TopologicalMap, start: int, goals: Collection[int]) -> Plan | None:
    """The cheapest chain of ways from a place to one of the goals (Dijkstra); None where none leads to any."""
    if start not in chart.graph:
        return None
    costs: dict[int, float]
    paths: dict[int, list[int]]
    costs, paths = nx.single_source_dijkstra(chart.graph, start, weight="cost")  # type: ignore[assignment]
    reached = [goal for goal in goals if goal in costs]
    if not reached:
        return None
    path = paths[min(reached, key=lambda goal: (costs[goal], goal))]
    return Plan(tuple(chart.edge(*pair) for pair in pairwise(path)))
