"""The chart: which places the robot knows, and the ways between them (paper, III.B and V.C).

A place is a situation of the mid level with all RLAs that stand on it; each of these is a way, to where its expectation
says that it leads.
"""

from collections import Counter
from collections.abc import Callable, Generator, Iterable, Mapping
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import networkx as nx
import numpy as np

from kurt2rt.core.planning.target import GroupAt, Vector
from kurt2rt.core.rla.condition import Condition
from kurt2rt.core.rla.rla import Rla

MapBuild = Generator[None, None, "TopologicalMap"]
"""A chart in the making: each piece of the work looks at one RLA, whose situation is matched at most once in it."""

_LIGHT = 8
"""So many RLAs make a piece of work where none of them is matched."""


class Forecast(Protocol):
    """What is expected of one RLA."""

    @property
    def mean(self) -> Vector:
        """The situation in which it ends."""
        ...

    @property
    def ticks(self) -> float:
        """How long it takes."""
        ...


@dataclass(frozen=True, slots=True)
class Place:
    """A situation of the mid level, and what can be done there."""

    place_id: int
    """The oldest of its RLAs; for one that nothing was taught at yet, less the RLA that leads there."""
    condition: Condition
    members: tuple[Rla, ...]
    """The RLAs on it, oldest first; none where nothing was taught yet."""


class Edge(NamedTuple):
    """From one place to another."""

    rla_id: int
    action: str
    start: int
    """Place where it begins."""
    end: int
    """Place where it leads."""
    share: float
    """How often it led there, of all the times that it was gone."""
    ticks: float
    """How long it is expected to take."""

    @property
    def cost(self) -> float:
        """Ticks, and those of the tries that lead elsewhere."""
        return self.ticks / self.share


class TopologicalMap:
    """Places and ways as a directed graph."""

    def __init__(self) -> None:
        self.places: dict[int, Place] = {}
        self.graph: nx.DiGraph[int] = nx.DiGraph()

    def add_place(self, place: Place) -> None:
        """Put a place on it."""
        self.places[place.place_id] = place
        self.graph.add_node(place.place_id)

    def add_edge(self, way: Edge) -> None:
        """Put a way on it; of several from one place to another only the cheapest stays."""
        known = (way.start, way.end) in self.graph.edges
        if not known or way.cost < self.graph.edges[way.start, way.end]["cost"]:
            self.graph.add_edge(way.start, way.end, cost=way.cost, way=way)

    def members(self, place_id: int) -> frozenset[int]:
        """Ids of the RLAs on a place."""
        return frozenset(rla.rla_id for rla in self.places[place_id].members)

    def edge(self, start: int, end: int) -> Edge:
        """The cheapest way from a place straight to another."""
        way: Edge = self.graph.edges[start, end]["way"]
        return way


def build_map(
    rlas: Iterable[Rla],
    group_at: GroupAt,
    follow_ups: Callable[[int], Mapping[int, int]],
    forecast: Callable[[int], Forecast | None],
) -> MapBuild:
    """Make the chart of all RLAs of the mid level, which must stay as they are until it stands.

    `follow_ups`: how often each RLA followed one.
    `forecast`: what is expected of one, None for one that was never seen to end. An RLA leads to the place that its
    expectation lies in, and as often as follow-ups of that place came; where expectations lie in no place, to where
    its follow-ups stand.
    """
    chart = TopologicalMap()
    members: dict[Condition, list[Rla]] = {}
    forecasts: dict[int, Forecast] = {}
    for number, rla in enumerate(rlas):
        members.setdefault(rla.condition, []).append(rla)
        expected = forecast(rla.rla_id)
        if expected is not None:
            forecasts[rla.rla_id] = expected
        if number % _LIGHT == 0:
            yield
    home: dict[int, int] = {}
    for number, (at, group) in enumerate(members.items()):
        chart.add_place(Place(group[0].rla_id, at, tuple(group)))
        home.update((rla.rla_id, group[0].rla_id) for rla in group)
        if number % _LIGHT == 0:
            yield
    usual_ticks = float(np.mean([each.ticks for each in forecasts.values()])) if forecasts else 1.0
    for start, place in list(chart.places.items()):
        for rla in place.members:
            if rla.is_withdrawn:
                continue
            ends = Counter[int]()
            for after, times in follow_ups(rla.rla_id).items():
                if after in home:
                    ends[home[after]] += times
            expected = forecasts.get(rla.rla_id)
            if expected is not None:
                end = _end_of(rla, expected, group_at, home, chart)
                if end > 0 or not ends:
                    ends[end] = max(ends[end], 1)
            ticks = usual_ticks if expected is None else max(expected.ticks, 1.0)
            seen = ends.total()
            for end, times in ends.items():
                if end != start:
                    chart.add_edge(Edge(rla.rla_id, rla.action, start, end, times / seen, ticks))
            yield
    return chart


def _end_of(
    rla: Rla,
    expected: Forecast,
    group_at: GroupAt,
    home: Mapping[int, int],
    chart: TopologicalMap,
) -> int:
    """The place that an expectation lies in; one that nothing was taught at yet is put on the chart."""
    there = group_at(expected.mean)
    if there:
        return home[there[0].rla_id]
    chart.add_place(Place(-rla.rla_id, tuple(expected.mean.tolist()), ()))
    return -rla.rla_id
