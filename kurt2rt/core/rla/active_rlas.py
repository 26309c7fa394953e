"""Active RLAs, and the search for the one nearest to a situation (paper, section III)."""

import math
from bisect import bisect_left
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import islice
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.rla.condition import Condition, Space
from kurt2rt.core.rla.image import Image
from kurt2rt.core.rla.matching import ConditionIndex, SymbolIndex
from kurt2rt.core.rla.rla import BASIC, Rla


class Match(NamedTuple):
    """Nearest RLA of a situation, its distance, and the runner-up: the result of `RlaSystem.match`.

    It answers if `distance` is at most its R (`radius`), 700 to 1180 counts in the shipped tasks. While a teacher is
    there, `radius` is the smaller limit from which the robot asks.
    """

    rla: Rla
    """Nearest RLA, also if the situation lies outside its radius."""
    distance: float
    radius: float
    runner_up: Rla | None
    runner_up_distance: float
    """Infinite without a runner-up."""

    @property
    def known(self) -> bool:
        """Return whether the situation lies inside the nearest RLA's confidence radius, and that RLA has an action."""
        return self.distance <= self.radius and not self.rla.is_withdrawn


class CandidateIndex:
    """Searchable conditions of the RLAs that compete at one level for one behaviour, with their RLAs."""

    def __init__(self, space: Space) -> None:
        self.weights = np.ones(space.dimensions) if space.weights is None else space.weights
        self.rlas: list[Rla] = []
        """Oldest first, each before its images."""
        self.index = _make_index(space)

    def add(self, rla: Rla) -> None:
        """Insert an RLA in the order of ids. Raises ValueError for a wrong length or a number that is not finite."""
        dimensions = len(self.weights)
        if len(rla.condition) != dimensions:
            raise ValueError(f"condition has {len(rla.condition)} values, this system matches {dimensions}")
        position = self._position(rla)
        self.index.insert(position, self._weighted(rla.condition))
        self.rlas.insert(position, rla)

    def replace(self, rla: Rla) -> None:
        """Replace the RLA of the same id and condition, which must be in the index."""
        self.rlas[self._position(rla)] = rla

    def remove(self, rla: Rla) -> None:
        """Remove an RLA, which must be in the index."""
        position = self._position(rla)
        self.index.remove(position)
        del self.rlas[position]

    def _position(self, rla: Rla) -> int:
        return bisect_left(self.rlas, rla.key, key=lambda each: each.key)

    def _weighted(self, condition: Condition) -> NDArray[np.float64]:
        weighted: NDArray[np.float64] = np.array(condition, dtype=np.float64) * self.weights
        return weighted


def _make_index(space: Space) -> ConditionIndex | SymbolIndex:
    if space.metric == "euclidean":
        return ConditionIndex(space.dimensions)
    if space.weights is not None:
        raise ValueError(f"symbols are equal or not: a space of metric {space.metric} takes no weights")
    return SymbolIndex(space.dimensions)


class ActiveRlas:
    """RLAs of all levels and behaviours. Among those of one level and behaviour the nearest wins."""

    def __init__(self, spaces: Mapping[str, Space], images: Sequence[Image] = ()) -> None:
        """Begin without RLAs.

        Args:
            spaces: by level; RLAs of other levels are kept, but never matched.
            images: in which each RLA of the basic level answers, too.
        """
        self._spaces = spaces
        self.images = {image.name: image for image in images}
        """By name."""
        self._rlas: dict[int, Rla] = {}
        self._indexes: dict[tuple[str, str], CandidateIndex] = {}
        """By level and behaviour."""
        self.radius_share = 1.0
        """Fraction of R, 0 to 1, within which RLAs of the basic level answer now; 1 unless a robot asks sooner."""
        self.is_guess: Callable[[Rla], bool] | None = None
        """Predicate of guesses, which a robot without a teacher passes over at the basic level; None: none is one."""
        self._groups = CompetitorGroups()
        self._counts: Counter[str] = Counter()

    def __len__(self) -> int:
        return self._counts[BASIC]

    @property
    def rlas(self) -> tuple[Rla, ...]:
        """All active RLAs of the basic level, of all behaviours, oldest first."""
        return self.rlas_at(BASIC)

    def rlas_at(self, level: str) -> tuple[Rla, ...]:
        """Return all active RLAs of a level, of all behaviours, oldest first."""
        return tuple(rla for rla in self._oldest_first() if rla.level == level)

    @property
    def active_rlas(self) -> tuple[Rla, ...]:
        """All active RLAs of all levels, in no order: a copy that is cheap enough for each tick."""
        return tuple(self._rlas.values())

    def get(self, rla_id: int) -> Rla | None:
        """Return the active RLA of an id, of any level; None if there is none."""
        return self._rlas.get(rla_id)

    def match(
        self, situation: NDArray[np.float64], behaviour: str = "", level: str = BASIC, *, include_withdrawn: bool = True
    ) -> Match | None:
        """Return the RLA of a level and taught behaviour nearest to a situation (d,), and the runner-up.

        Returns None if nothing was taught yet. All distances are infinite if the situation holds NaN: the robot does
        not know its position. `include_withdrawn`: False passes over RLAs without an action, and guesses, for a robot
        without a teacher.
        """
        index = self._indexes.get((level, behaviour))
        nearest = None if index is None else index.index.nearest(situation * index.weights)
        if index is None or nearest is None:
            return None
        rla = index.rlas[nearest.position]
        if not include_withdrawn and self.passes_over(rla):
            return self._match_of_others(index, situation)
        runner_up = index.rlas[nearest.runner_up] if nearest.runner_up >= 0 else None
        radius = self.radius_of(rla)
        if math.isnan(nearest.distance):
            return Match(rla, math.inf, radius, runner_up, math.inf)
        return Match(rla, nearest.distance, radius, runner_up, nearest.runner_up_distance)

    def passes_over(self, rla: Rla) -> bool:
        """Return whether a robot without a teacher lets neighbours of an RLA answer: of a withdrawn one and a guess."""
        return rla.is_withdrawn or (rla.level == BASIC and self.is_guess is not None and self.is_guess(rla))

    def radius_of(self, rla: Rla) -> float:
        """Return the distance in counts, or m for a place, up to which an RLA of a matched level answers now."""
        radius = self.whole_radius(rla)
        return radius * self.radius_share if rla.level == BASIC else radius

    def whole_radius(self, rla: Rla) -> float:
        """Return R of an RLA of a matched level in counts, or m for a place, also while the robot asks sooner."""
        return self._spaces[rla.level].radius if rla.radius is None else rla.radius

    def _match_of_others(self, index: CandidateIndex, situation: NDArray[np.float64]) -> Match | None:
        """Return the nearest RLA that is not passed over. Computes all distances: rare, so not optimised."""
        distances = index.index.distances(situation * index.weights)
        order = np.argsort(distances, kind="stable").tolist()  # stable: the older of equally near RLAs comes first
        found = list(islice((place for place in order if not self.passes_over(index.rlas[place])), 2))
        if not found:
            return None
        rla = index.rlas[found[0]]
        radius = self.radius_of(rla)
        if len(found) == 1:
            return Match(rla, float(distances[found[0]]), radius, None, math.inf)
        runner_up = index.rlas[found[1]]
        return Match(rla, float(distances[found[0]]), radius, runner_up, float(distances[found[1]]))

    def nearest_first(
        self, situation: NDArray[np.float64], behaviour: str = "", level: str = BASIC, *, limit: int | None = None
    ) -> tuple[tuple[Rla, float], ...]:
        """Return (RLA, distance) of the RLAs of a level and behaviour, nearest to a situation (d,) first.

        Computes all distances: for explanations, not for each tick. `limit`: largest number of RLAs; None: all.
        """
        index = self._indexes.get((level, behaviour))
        if index is None or not index.rlas:
            return ()
        distances = index.index.distances(situation * index.weights)
        if limit is None or limit >= len(distances):
            order = np.argsort(distances, kind="stable").tolist()
        else:
            # Sort only the rows up to the limit-th distance; NaN sorts last.
            farthest = np.partition(distances, limit - 1)[limit - 1]
            near = np.flatnonzero((distances <= farthest) | np.isnan(farthest))
            order = near[np.argsort(distances[near], kind="stable")][:limit].tolist()
        return tuple(
            (index.rlas[place], math.inf if math.isnan(distances[place]) else float(distances[place]))
            for place in order
        )

    def candidate_count(self, behaviour: str = "", level: str = BASIC) -> int:
        """Return the number of RLAs that compete at a level for a behaviour; one and its images count once."""
        index = self._indexes.get((level, behaviour))
        return 0 if index is None else len({rla.rla_id for rla in index.rlas})

    def candidates(self, behaviour: str = "") -> tuple[Rla, ...]:
        """Return the RLAs of the basic level that compete for a behaviour, images included, oldest first."""
        index = self._indexes.get((BASIC, behaviour))
        return () if index is None else tuple(index.rlas)

    @property
    def matched_rlas(self) -> tuple[Rla, ...]:
        """All RLAs of the basic level that are matched, of all behaviours, images included."""
        return tuple(rla for (level, _), index in self._indexes.items() if level == BASIC for rla in index.rlas)

    def competitors(self, rla: Rla) -> tuple[Rla, ...]:
        """Return the RLAs of its level and behaviour with an equal condition, itself included, oldest first."""
        group = self._groups.for_rla(rla)
        if not rla.image:
            return group
        return (rla,) if len(group) == 1 else tuple(map(self.images[rla.image].rla, group))

    def is_estimate(self, match: Match) -> bool:
        """Return whether the nearest RLA is near only in an image that was estimated, and not at its very condition."""
        image = self.images.get(match.rla.image)
        return image is not None and image.estimated and match.distance > 0.0

    def as_taught(self, rla: Rla, action: str) -> str:
        """Return the action of an RLA that makes a matched one, which may be an image, have `action`."""
        return self.images[rla.image].name_of(action) if rla.image else action

    def neighbours(self, rla: Rla, count: int) -> tuple[Rla, ...]:
        """Return at most `count` RLAs of its level and behaviour with another condition, nearest first; sorts all."""
        near = self.nearest_first(np.array(rla.condition, dtype=np.float64), rla.behaviour, rla.level)
        return tuple(islice((other for other, _ in near if other.condition != rla.condition), count))

    def _oldest_first(self) -> Iterator[Rla]:
        return (self._rlas[rla_id] for rla_id in sorted(self._rlas))

    def _add(self, rla: Rla) -> None:
        """Add an RLA. Raises ValueError, changing nothing, if its condition cannot be matched."""
        space = self._spaces.get(rla.level)
        if space is not None:
            for each in self._images(rla):
                index = self._indexes.get((rla.level, each.behaviour)) or CandidateIndex(space)
                index.add(each)
                self._indexes[rla.level, each.behaviour] = index
        self._keep(rla)
        self._counts[rla.level] += 1

    def _replace(self, rla: Rla) -> None:
        """Replace the active RLA that has the id and the condition of `rla`."""
        if rla.level in self._spaces:
            for each in self._images(rla):
                self._indexes[rla.level, each.behaviour].replace(each)
        self._keep(rla)

    def _remove(self, rla: Rla) -> Rla:
        """Remove an active RLA and return it. Raises KeyError if none has its id."""
        if rla.level in self._spaces:
            for each in self._images(rla):
                self._indexes[rla.level, each.behaviour].remove(each)
        self._groups.remove(rla)
        self._counts[rla.level] -= 1
        return self._rlas.pop(rla.rla_id)

    def _keep(self, rla: Rla) -> None:
        self._rlas[rla.rla_id] = rla
        self._groups.add_or_replace(rla)

    def _images(self, rla: Rla) -> tuple[Rla, ...]:
        """Return what of an RLA is matched: itself, and its images."""
        return (rla,) if rla.level != BASIC else (rla, *(image.rla(rla) for image in self.images.values()))


class CompetitorGroups:
    """Index of active RLAs that compete: equal level, behaviour and condition, but different actions."""

    def __init__(self) -> None:
        self._members: dict[tuple[str, str, Condition], tuple[Rla, ...]] = {}
        """Oldest first."""
        self._group: dict[int, tuple[Rla, ...]] = {}
        """By member id: read in each tick, in which hashing a condition would cost more than the lookup."""

    def for_rla(self, rla: Rla) -> tuple[Rla, ...]:
        """Return the active RLAs on the condition of an RLA, oldest first; the RLA itself may be deleted."""
        group = self._group.get(rla.rla_id)
        if group is None:
            return self._members.get(_group_key(rla), ())
        return group

    def add_or_replace(self, rla: Rla) -> None:
        """Add an RLA, or replace the one of its id."""
        self._regroup(rla, (*self._others(rla), rla))

    def remove(self, rla: Rla) -> None:
        """Remove an RLA from the group of its condition. Raises KeyError if it is in none."""
        others = self._others(rla)
        del self._group[rla.rla_id]
        if others:
            self._regroup(rla, others)
        else:
            del self._members[_group_key(rla)]

    def _others(self, rla: Rla) -> tuple[Rla, ...]:
        return tuple(each for each in self._members.get(_group_key(rla), ()) if each.rla_id != rla.rla_id)

    def _regroup(self, rla: Rla, members: tuple[Rla, ...]) -> None:
        group = self._members[_group_key(rla)] = tuple(sorted(members, key=lambda member: member.rla_id))
        for member in group:
            self._group[member.rla_id] = group


def _group_key(rla: Rla) -> tuple[str, str, Condition]:
    return rla.level, rla.behaviour, rla.condition
