"""RLAs that compete for the situations of one level and taught behaviour."""

from bisect import bisect_left

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.rla.condition import Condition
from kurt2rt.core.rla.matching import ConditionIndex
from kurt2rt.core.rla.space import Space
from kurt2rt.core.rla.symbol_index import SymbolIndex


class CandidateIndex:
    """Ids of competing RLAs, in the row order of the index of their conditions."""

    def __init__(self, space: Space) -> None:
        self.weights = np.ones(space.dimensions) if space.weights is None else space.weights
        self.ids: list[int] = []
        """Oldest first."""
        self.index = _make_index(space)

    def add(self, rla_id: int, condition: Condition) -> None:
        """Insert an RLA in the order of ids. Raises ValueError for a wrong length or a number that is not finite."""
        dimensions = len(self.weights)
        if len(condition) != dimensions:
            raise ValueError(f"condition has {len(condition)} values, this system matches {dimensions}")
        position = bisect_left(self.ids, rla_id)
        self.index.insert(position, self._weighted(condition))
        self.ids.insert(position, rla_id)

    def remove(self, rla_id: int) -> None:
        """Remove an RLA, which must be in the index."""
        position = bisect_left(self.ids, rla_id)
        self.index.remove(position)
        del self.ids[position]

    def nearest_first(self, condition: Condition) -> list[int]:
        """Return all ids, nearest to an unweighted condition first; of equally near RLAs the older first."""
        order = np.argsort(self.index.distances(self._weighted(condition)), kind="stable")
        return [self.ids[position] for position in order.tolist()]

    def _weighted(self, condition: Condition) -> NDArray[np.float64]:
        weighted: NDArray[np.float64] = np.array(condition, dtype=np.float64) * self.weights
        return weighted


def _make_index(space: Space) -> ConditionIndex | SymbolIndex:
    if space.metric == "euclidean":
        return ConditionIndex(space.dimensions)
    if space.weights is not None:
        raise ValueError(f"symbols are equal or not: a space of metric {space.metric} takes no weights")
    return SymbolIndex(space.dimensions)
