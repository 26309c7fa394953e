"""A look over all that is known before a plan is made: as much of it in each tick as a tick has time for."""

from collections.abc import Generator

import numpy as np

from kurt2rt.core.planning.target import Target
from kurt2rt.core.planning.topological_map import MapBuild, TopologicalMap


class MapBuilder:
    """Makes the chart, and finds the places on it at which a target is reached."""

    def __init__(self, build_map: MapBuild, target: Target) -> None:
        """`build_map`: not begun yet."""
        self._work = self._build(build_map, target)
        self.topological_map: TopologicalMap | None = None
        """None until it stands."""
        self.goals: set[int] = set()
        """Ids of the places at which the target is reached; all of them when the survey is done."""

    def step(self, pieces: int) -> bool:
        """Look at so many RLAs or places more; whether nothing is left to look at."""
        return any(next(self._work, True) for _ in range(pieces))

    def _build(self, build_map: MapBuild, target: Target) -> Generator[bool, None, None]:
        while self.topological_map is None:
            try:
                next(build_map)
            except StopIteration as stands:
                self.topological_map = stands.value
            yield False
        for place_id, place in self.topological_map.places.items():
            if target.matches(np.array(place.condition)):
                self.goals.add(place_id)
            yield False
