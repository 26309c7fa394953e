"""The RLA system: a set of RLAs, of which the nearest one inside its radius answers a situation (paper, III)."""

import hashlib
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kurt2rt.rla.matching import ConditionIndex
from kurt2rt.rla.rla import ActionReplaced, Condition, Rla, RlaCreated, RlaDeleted, TeachingEvent


class Match(NamedTuple):
    """Answer of an RLA system to a situation."""

    rla: Rla
    """The nearest RLA, also when the situation lies outside its radius."""
    distance: float
    radius: float
    runner_up: Rla | None
    runner_up_distance: float
    """Infinite where there is no runner-up."""

    @property
    def known(self) -> bool:
        """Whether the situation lies within the nearest RLA's confidence radius."""
        return self.distance <= self.radius


class UnfitEventError(ValueError):
    """A teaching event does not fit the knowledge it should change."""


class RlaSystem:
    """The fold of teaching events; winner takes all by Euclidean distance."""

    def __init__(self, dimensions: int, radius: float, weights: NDArray[np.float64] | None = None) -> None:
        """`weights`, shape (dimensions,): how much each feature counts in a distance; all count 1 unless given."""
        self.dimensions = dimensions
        self.radius = radius
        self.weights = np.ones(dimensions) if weights is None else weights
        self._rlas: list[Rla] = []
        self._position: dict[int, int] = {}
        self._index = ConditionIndex(dimensions)
        self._last_id = 0

    def __len__(self) -> int:
        return len(self._rlas)

    @property
    def rlas(self) -> tuple[Rla, ...]:
        """All living RLAs, oldest first."""
        return tuple(self._rlas)

    @property
    def next_id(self) -> int:
        """Id of the next RLA to be taught; ids of deleted RLAs are never given again."""
        return self._last_id + 1

    def get(self, rla_id: int) -> Rla | None:
        """The living RLA of that id."""
        position = self._position.get(rla_id)
        return None if position is None else self._rlas[position]

    def match(self, situation: NDArray[np.float64]) -> Match | None:
        """The nearest RLA to a situation vector (d,), and the one behind it; None when nothing was taught yet."""
        nearest = self._index.nearest(situation * self.weights)
        if nearest is None:
            return None
        rla = self._rlas[nearest.position]
        runner_up = self._rlas[nearest.runner_up] if nearest.runner_up >= 0 else None
        radius = self.radius if rla.radius is None else rla.radius
        return Match(rla, nearest.distance, radius, runner_up, nearest.runner_up_distance)

    def apply(self, event: TeachingEvent) -> None:
        """Change the knowledge as the event says. Raises UnfitEventError, and changes nothing, when it does not fit."""
        match event:
            case RlaCreated(rla):
                if rla.rla_id <= self._last_id:
                    raise UnfitEventError(f"RLA {rla.rla_id} cannot be created: ids up to {self._last_id} are taken")
                try:
                    self._index.append(self._weighted(rla.condition))
                except ValueError as error:
                    raise UnfitEventError(f"RLA {rla.rla_id}: {error}") from error
                self._position[rla.rla_id] = len(self._rlas)
                self._rlas.append(rla)
                self._last_id = rla.rla_id
            case ActionReplaced(rla_id, action, _, origin):
                position = self._living(rla_id)
                old = self._rlas[position]
                self._rlas[position] = Rla(old.rla_id, old.condition, action, old.radius, origin)
            case RlaDeleted(rla_id, _):
                position = self._living(rla_id)
                self._index.remove(position)
                del self._rlas[position]
                self._position = {rla.rla_id: place for place, rla in enumerate(self._rlas)}

    def apply_all(self, events: Iterable[TeachingEvent]) -> None:
        """Apply events in order."""
        for event in events:
            self.apply(event)

    def knowledge_hash(self) -> str:
        """Fingerprint of what the system knows: ids, conditions, actions and radii, not who taught them or when."""
        digest = hashlib.sha256()
        for rla in self._rlas:
            digest.update(f"{rla.rla_id} {rla.action} {rla.radius!r} ".encode())
            digest.update(np.array(rla.condition, dtype=np.float64).tobytes())
        return digest.hexdigest()

    def _weighted(self, condition: Condition) -> tuple[float, ...]:
        if len(condition) != self.dimensions:
            raise ValueError(f"condition has {len(condition)} values, this system matches {self.dimensions}")
        return tuple((np.array(condition, dtype=np.float64) * self.weights).tolist())

    def _living(self, rla_id: int) -> int:
        position = self._position.get(rla_id)
        if position is None:
            raise UnfitEventError(f"there is no RLA {rla_id}; living ones: 1 to {self._last_id}, fewer the deleted")
        return position
