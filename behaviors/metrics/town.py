"""Streets as one goes through them: each in either direction, with what leads on from its end, and shortest ways."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from behaviors.metrics.streets import Junction, Side, StreetMap, side_towards
from hal.numerics import cos_sin
from simbridge.contracts.simulation import Pose


@dataclass(frozen=True, slots=True)
class Street:
    """Stretch of street from the junction `behind` to the junction `ahead`, driven in the direction `way`."""

    way: Side
    behind: Junction
    ahead: Junction

    @property
    def length_m(self) -> float:
        """Distance in m between the centres of both junctions."""
        return math.hypot(self.ahead.x_m - self.behind.x_m, self.ahead.y_m - self.behind.y_m)

    @property
    def middle(self) -> Pose:
        """Pose half-way along, in the direction of the street."""
        x_m, y_m = (self.ahead.x_m + self.behind.x_m) / 2, (self.ahead.y_m + self.behind.y_m) / 2
        return Pose(x_m, y_m, self.way.heading_rad)


class Town:
    """Streets of a world in both directions, and the shortest ways between them by the robot's behaviours."""

    def __init__(self, streets: StreetMap, meaning: Mapping[str, int]) -> None:
        """`meaning`: quarter turns to the left of each behaviour."""
        # Late import: networkx is in the extra `simulation`, and a robot reads the settings of a task in a town.
        import networkx as nx

        self._map = streets
        self.streets = tuple(self._all())
        self._of = {(street.way, street.ahead): street for street in self.streets}
        self._meaning = dict(meaning)
        self._graph: nx.DiGraph[Street] = nx.DiGraph()
        self._graph.add_nodes_from(self.streets)
        for street in self.streets:
            for on in self.on_from(street).values():
                self._graph.add_edge(street, on, length_m=street.length_m)

    def street_at(self, pose: Pose) -> Street | None:
        """Return the street that a pose lies in and looks along; None within a junction and off the streets."""
        if any(each.holds(pose) for each in self._map.junctions):
            return None
        way = side_towards(*cos_sin(pose.heading_rad))
        ahead = self._map.next_junction(pose, way)
        return None if ahead is None else self._of.get((way, ahead))

    def on_from(self, street: Street) -> dict[str, Street]:
        """Return the street that follows a street, by each behaviour that is possible at its end."""
        found = {}
        for behaviour, quarters in self._meaning.items():
            way = street.way.turned(quarters)
            if way in street.ahead.arms:
                on = next((each for each in self.streets if each.behind == street.ahead and each.way is way), None)
                if on is not None:
                    found[behaviour] = on
        return found

    def shortest(self, start: Street, goal: Street) -> tuple[Street, ...] | None:
        """Return the streets of the shortest way, start and goal included; None without a way."""
        import networkx as nx  # late as above

        try:
            return tuple(nx.dijkstra_path(self._graph, start, goal, weight="length_m"))
        except nx.NetworkXNoPath:
            return None

    def nearest(self, start: Street, goals: Sequence[Street]) -> tuple[Street, ...] | None:
        """Return the streets of the shortest way to the nearest goal, both ends included; None without a way."""
        ways = [way for goal in goals if (way := self.shortest(start, goal)) is not None]
        return min(ways, key=lambda way: length_m(way), default=None)

    def _all(self) -> list[Street]:
        found = []
        for behind in self._map.junctions:
            for way in sorted(behind.arms):
                ahead = self._map.neighbour(behind, way)
                if ahead is not None:
                    found.append(Street(way, behind, ahead))
        return found


def length_m(way: Sequence[Street], start: Pose | None = None, end: Pose | None = None) -> float:
    """Return the length in m along the middles of streets, from a pose in the first to one in the last.

    Args:
        way: streets in their order, at least one.
        start: None: the middle of the first street.
        end: None: the middle of the last street.
    """
    start, end = start or way[0].middle, end or way[-1].middle
    corners = [(each.ahead.x_m, each.ahead.y_m) for each in way[:-1]]
    points = [(start.x_m, start.y_m), *corners, (end.x_m, end.y_m)]
    return math.fsum(math.hypot(bx - ax, by - ay) for (ax, ay), (bx, by) in pairwise(points))
