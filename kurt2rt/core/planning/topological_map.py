"""Topological map: known places and the edges between them (paper, sections III.B and V.C).

A place is a mid-level situation with all RLAs on it. Each RLA is an edge to the place of its expectation.
"""

from collections import Counter
from collections.abc import Callable, Collection, Generator, Iterable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from kurt2rt.core.planning.target import GroupAt, Target
from kurt2rt.core.rla.condition import Condition
from kurt2rt.core.rla.rla import Rla
from kurt2rt.core.rla.statistics import Expectation

MapBuild = Generator[None, None, "TopologicalMap"]
"""Generator that builds a map; each piece processes one RLA with at most one match."""

_RLAS_PER_PIECE = 8
"""RLAs per piece in stages without a match."""


@dataclass(frozen=True, slots=True)
class Place:
    """Node of the topological map: a mid-level situation, and the RLAs that are taught there."""

    place_id: int
    """Id of its oldest RLA; of an untaught place the negative id of the RLA that leads there."""
    condition: Condition
    members: tuple[Rla, ...]
    """RLAs on it, oldest first; empty for an untaught place."""


class Edge(NamedTuple):
    """Edge of the topological map: an RLA's drive from its own place to the place where it ends."""

    rla_id: int
    action: str
    start: int
    """Place at its beginning."""
    end: int
    """Place at its end."""
    share: float
    """Share of its drives that ended there, 0 to 1."""
    ticks: float
    """Expected duration."""

    @property
    def cost(self) -> float:
        """Expected ticks, failed attempts included."""
        return self.ticks / self.share


class TopologicalMap:
    """Directed graph of places, and of the RLAs that lead from one to another (paper, sections III.B and V.C).

    Nothing draws it by hand: each mid-level RLA is an edge from its condition to its expectation. An edge costs
    `ticks / share`, so unreliable ones are dear. `GoalPursuit` finds the cheapest way (Dijkstra).
    """

    def __init__(self) -> None:
        self.places: dict[int, Place] = {}
        self._edges: dict[int, dict[int, Edge]] = {}
        """Edges by start and end."""

    def add_edge(self, edge: Edge) -> None:
        """Add an edge between two places; of parallel edges only the cheapest is kept."""
        edges = self._edges.setdefault(edge.start, {})
        if edge.end not in edges or edge.cost < edges[edge.end].cost:
            edges[edge.end] = edge

    def edges_from(self, place_id: int) -> Collection[Edge]:
        """Return the edges that start at a place, in the order in which their ends were first led to."""
        return self._edges.get(place_id, {}).values()

    def members(self, place_id: int) -> frozenset[int]:
        """Return the ids of the RLAs on a place. Raises KeyError for an unknown place."""
        return frozenset(rla.rla_id for rla in self.places[place_id].members)


def build_map(
    rlas: Iterable[Rla],
    group_at: GroupAt,
    follow_ups: Callable[[int], Mapping[int, int]],
    forecast: Callable[[int], Expectation | None],
) -> MapBuild:
    """Build the map of the mid-level RLAs, which must not change meanwhile; yield after each piece.

    An RLA leads to the place of its expectation and to the places of its follow-ups, in the share of their counts.
    `follow_ups`: RLA id -> {follow-up id: count}. `forecast`: expectation of an RLA; None before its first end.
    """
    result = TopologicalMap()
    members: dict[Condition, list[Rla]] = {}
    forecasts: dict[int, Expectation] = {}
    for number, rla in enumerate(rlas):
        members.setdefault(rla.condition, []).append(rla)
        expected = forecast(rla.rla_id)
        if expected is not None:
            forecasts[rla.rla_id] = expected
        if number % _RLAS_PER_PIECE == 0:
            yield
    home: dict[int, int] = {}
    for number, (at, group) in enumerate(members.items()):
        result.places[group[0].rla_id] = Place(group[0].rla_id, at, tuple(group))
        home.update((rla.rla_id, group[0].rla_id) for rla in group)
        if number % _RLAS_PER_PIECE == 0:
            yield
    usual_ticks = float(np.mean([each.ticks for each in forecasts.values()])) if forecasts else 1.0
    for start, place in list(result.places.items()):
        for rla in place.members:
            if rla.is_withdrawn:
                continue
            ends = Counter[int]()
            for after, times in follow_ups(rla.rla_id).items():
                if after in home:
                    ends[home[after]] += times
            expected = forecasts.get(rla.rla_id)
            if expected is not None:
                end = _end_of(rla, expected, group_at, home, result)
                if end > 0 or not ends:
                    ends[end] = max(ends[end], 1)
            ticks = usual_ticks if expected is None else max(expected.ticks, 1.0)
            seen = ends.total()
            for end, times in ends.items():
                if end != start:
                    result.add_edge(Edge(rla.rla_id, rla.action, start, end, times / seen, ticks))
            yield
    return result


def _end_of(
    rla: Rla,
    expected: Expectation,
    group_at: GroupAt,
    home: Mapping[int, int],
    result: TopologicalMap,
) -> int:
    """Return the place of an expectation; add an untaught place if there is none."""
    there = group_at(expected.mean)
    if there:
        return home[there[0].rla_id]
    result.places[-rla.rla_id] = Place(-rla.rla_id, tuple(expected.mean.tolist()), ())
    return -rla.rla_id


class MapBuilder:
    """Construction of the map and search for its goal places, in pieces that fit into ticks."""

    def __init__(self, build: MapBuild, target: Target) -> None:
        """`build`: not started yet."""
        self._work = self._build(build, target)
        self.topological_map: TopologicalMap | None = None
        """None until the map is complete."""
        self.goals: set[int] = set()
        """Ids of the places that match the target; complete when the work is done."""

    def step(self, pieces: int) -> bool:
        """Process at most `pieces` RLAs or places; return whether map and goals are complete."""
        return any(next(self._work, True) for _ in range(pieces))

    def _build(self, build: MapBuild, target: Target) -> Generator[bool, None, None]:
        while self.topological_map is None:
            try:
                next(build)
            except StopIteration as done:
                self.topological_map = done.value
            yield False
        for place_id, place in self.topological_map.places.items():
            if target(np.array(place.condition)):
                self.goals.add(place_id)
            yield False
