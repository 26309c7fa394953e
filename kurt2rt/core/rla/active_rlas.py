"""The RLAs that live, and which of them answers a situation: the nearest one (paper, III)."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.rla.candidate_index import CandidateIndex
from kurt2rt.core.rla.competitors import CompetitorGroups
from kurt2rt.core.rla.match import Match
from kurt2rt.core.rla.rla import Rla
from kurt2rt.core.rla.space import Space


class ActiveRlas:
    """Of all levels and behaviours; winner takes all by distance, among the RLAs of one level and taught behaviour."""

    def __init__(self, spaces: Mapping[str, Space]) -> None:
        """`spaces`: by level. With RLAs of a level that is not among them nothing is matched."""
        self._spaces = spaces
        self._rlas: dict[int, Rla] = {}
        self._indexes: dict[tuple[str, str], CandidateIndex] = {}
        """By level and behaviour."""
        self._groups = CompetitorGroups()
        self._count_at: Counter[str] = Counter()

    def __iter__(self) -> Iterator[Rla]:
        """Of all levels, oldest first."""
        return (self._rlas[rla_id] for rla_id in sorted(self._rlas))

    @property
    def unsorted(self) -> tuple[Rla, ...]:
        """Of all levels, in no order: a copy that costs a tick next to nothing."""
        return tuple(self._rlas.values())

    def count(self, level: str) -> int:
        """How many of a level live."""
        return self._count_at[level]

    def get(self, rla_id: int) -> Rla | None:
        """The living RLA of that id, of whatever level."""
        return self._rlas.get(rla_id)

    def match(self, situation: NDArray[np.float64], behaviour: str, level: str, asking: bool) -> Match | None:
        """The nearest to a situation (d,), and the one behind it; None where there is none of that level and behaviour.

        All are infinitely far from a situation that holds NaN. `asking`: False passes over those that ask.
        """
        contest = self._indexes.get((level, behaviour))
        nearest = None if contest is None else contest.index.nearest(situation * contest.weights)
        if contest is None or nearest is None:
            return None
        rla = self._rlas[contest.ids[nearest.position]]
        if not asking and rla.is_withdrawn:
            return self._match_without_withdrawn(contest, situation)
        runner_up = self._rlas[contest.ids[nearest.runner_up]] if nearest.runner_up >= 0 else None
        radius = contest.radius if rla.radius is None else rla.radius
        if math.isnan(nearest.distance):  # of a robot that does not know where it is: far from all, not near nothing
            return Match(rla, math.inf, radius, runner_up, math.inf)
        return Match(rla, nearest.distance, radius, runner_up, nearest.runner_up_distance)

    def _match_without_withdrawn(self, contest: CandidateIndex, situation: NDArray[np.float64]) -> Match | None:
        """The nearest that has an action: looks at all, for it is seldom needed."""
        distances = contest.index.distances(situation * contest.weights)
        order = np.argsort(distances, kind="stable").tolist()  # of equally near ones the older
        found = [place for place in order if not self._rlas[contest.ids[place]].is_withdrawn][:2]
        if not found:
            return None
        rla = self._rlas[contest.ids[found[0]]]
        radius = contest.radius if rla.radius is None else rla.radius
        if len(found) == 1:
            return Match(rla, float(distances[found[0]]), radius, None, math.inf)
        runner_up = self._rlas[contest.ids[found[1]]]
        return Match(rla, float(distances[found[0]]), radius, runner_up, float(distances[found[1]]))

    def nearest_first(
        self, situation: NDArray[np.float64], behaviour: str, level: str, most: int | None
    ) -> tuple[tuple[int, float], ...]:
        """Ids and distances of the RLAs of a level and behaviour, the nearest to a situation (d,) first.

        `most`: so many of them; None: all. Looks at all of them: to explain with, not for every tick.
        """
        contest = self._indexes.get((level, behaviour))
        if contest is None or not contest.ids:
            return ()
        distances = contest.index.distances(situation * contest.weights)
        if most is None or most >= len(distances):
            order = np.argsort(distances, kind="stable").tolist()  # of equally near ones the older
        else:
            # Only those as near as the last one that is wanted are put in order; NaN, far off, comes behind all.
            limit = np.partition(distances, most - 1)[most - 1]
            near = np.flatnonzero((distances <= limit) | np.isnan(limit))
            order = near[np.argsort(distances[near], kind="stable")][:most].tolist()
        return tuple(
            (contest.ids[place], math.inf if math.isnan(distances[place]) else float(distances[place]))
            for place in order
        )

    def candidate_count(self, behaviour: str, level: str) -> int:
        """How many RLAs of a level and behaviour compete."""
        contest = self._indexes.get((level, behaviour))
        return 0 if contest is None else len(contest.ids)

    def competitors(self, rla: Rla) -> tuple[Rla, ...]:
        """Those of its level and behaviour with exactly its condition, itself among them, oldest first."""
        return self._groups.for_rla(rla)

    def neighbours(self, rla: Rla, count: int) -> tuple[Rla, ...]:
        """Those of its level and behaviour with another condition, nearest first, at most `count`; sorts all."""
        contest = self._indexes.get((rla.level, rla.behaviour))
        if contest is None:
            return ()
        others = (self._rlas[rla_id] for rla_id in contest.nearest_first(rla.condition))
        return tuple(islice((other for other in others if other.condition != rla.condition), count))

    def add(self, rla: Rla) -> None:
        """One begins to live. Raises ValueError, and changes nothing, where its condition cannot be matched."""
        space = self._spaces.get(rla.level)
        if space is not None:
            contest = self._indexes.get((rla.level, rla.behaviour)) or CandidateIndex(space)
            contest.add(rla.rla_id, rla.condition)
            self._indexes[rla.level, rla.behaviour] = contest
        self.replace(rla)
        self._count_at[rla.level] += 1

    def replace(self, rla: Rla) -> None:
        """In the place of one that lives, with the same condition."""
        self._rlas[rla.rla_id] = rla
        self._groups.add_or_replace(rla)

    def remove(self, rla: Rla) -> Rla:
        """One that lives does so no more; returns it."""
        if rla.level in self._spaces:
            self._indexes[rla.level, rla.behaviour].remove(rla.rla_id)
        self._groups.remove(rla)
        self._count_at[rla.level] -= 1
        return self._rlas.pop(rla.rla_id)
