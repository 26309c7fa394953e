"""Town for plans: named places, and edges taught as mid-level RLAs."""

from collections import Counter

import numpy as np

from kurt2rt.core.planning.target import Vector, feature_target
from kurt2rt.core.planning.topological_map import MapBuild, MapBuilder, TopologicalMap, build_map
from kurt2rt.core.rla.condition import Space
from kurt2rt.core.rla.rla import MID, Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import Expectation, pack
from tests.core.rla.helpers import created

SPACE = Space(3, 0.5, np.array([1.0, 1.0, 0.0]))
FEATURES = ("x_m", "y_m", "wall_left")


def ended(at: Vector, ticks: float) -> Expectation:
    """Return the expectation of an RLA that ended at a situation once."""
    return Expectation("", 1, ticks, pack(at), pack(0 * at))


class Town:
    """Places and ways."""

    def __init__(self, **places: tuple[float, float]) -> None:
        self.places = places
        self.walled: set[str] = set()
        self.system = RlaSystem(2, 1.0, others={MID: SPACE})
        self.follow_ups: Counter[tuple[int, int]] = Counter()
        self.seen: dict[int, Expectation] = {}

    def at(self, place: str) -> Vector:
        """Return the situation of a place."""
        return np.array([*self.places[place], float(place in self.walled)])

    def teach(self, place: str, action: str) -> int:
        """Something can be done at a place; the id of the new RLA."""
        rla_id = self.system.next_id
        self.system.apply(created(rla_id, tuple(self.at(place).tolist()), action, level=MID))
        return rla_id

    def way(self, start: str, action: str, end: str, ticks: float = 800.0) -> int:
        """Taught, and gone once."""
        rla_id = self.teach(start, action)
        self.seen[rla_id] = ended(self.at(end), ticks)
        return rla_id

    def group_at(self, situation: Vector) -> tuple[Rla, ...]:
        """Return the RLAs on the place of a situation."""
        match = self.system.match(situation, level=MID)
        return self.system.competitors(match.rla) if match is not None and match.known else ()

    def build_map(self) -> MapBuild:
        """Begin a chart of what is known now."""
        return build_map(self.system.rlas_at(MID), self.group_at, self.followed, self.seen.get)

    def chart(self) -> TopologicalMap:
        """Return the complete map."""
        survey = MapBuilder(self.build_map(), feature_target({}, 0.0))
        while not survey.step(1):
            pass
        assert survey.topological_map is not None
        return survey.topological_map

    def followed(self, rla_id: int) -> dict[int, int]:
        """Return follow-up id -> count."""
        return {after: times for (before, after), times in self.follow_ups.items() if before == rla_id}

    def distance(self, a: Vector, b: Vector) -> float:
        """Return the distance in the space of the mid level."""
        return float(np.linalg.norm((a - b)[:2]))
