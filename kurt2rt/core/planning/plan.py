"""Plan: the chain of edges from a place to a goal."""

import heapq
import math
from collections.abc import Collection
from dataclasses import dataclass

from kurt2rt.core.planning.topological_map import Edge, TopologicalMap


@dataclass(frozen=True, slots=True)
class Plan:
    """Consecutive edges in driving order."""

    edges: tuple[Edge, ...]

    @property
    def ticks(self) -> float:
        """Expected duration in ticks."""
        return math.fsum(edge.ticks for edge in self.edges)

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
    if start not in topological_map.places:
        return None
    costs, last = _cheapest_edges(topological_map, start)
    reached = [goal for goal in goals if goal in costs]
    if not reached:
        return None
    place = min(reached, key=lambda goal: (costs[goal], goal))
    edges = []
    while place != start:
        edges.append(last[place])
        place = last[place].start
    return Plan(tuple(reversed(edges)))


def _cheapest_edges(topological_map: TopologicalMap, start: int) -> tuple[dict[int, float], dict[int, Edge]]:
    """Return the cost of each reachable place and the last edge of its cheapest path; the first found path wins a tie.

    Own code: networkx takes 17 MB, more than any other package of a robot but numpy.
    """
    costs: dict[int, float] = {}
    last: dict[int, Edge] = {}
    cheapest = {start: 0.0}
    waiting = [(0.0, 0, start)]
    pushed = 0
    while waiting:
        cost, _, place = heapq.heappop(waiting)
        if place in costs:
            continue
        costs[place] = cost
        for edge in topological_map.edges_from(place):
            total = cost + edge.cost
            if edge.end not in cheapest or total < cheapest[edge.end]:
                cheapest[edge.end], last[edge.end] = total, edge
                pushed += 1
                heapq.heappush(waiting, (total, pushed, edge.end))
    return costs, last
