"""Weights on the edges of the RLA network (Illerhues and Goerke 2007); smaller is better.

Each used edge begins at 100. A reward of +1 multiplies the weights of the last three transitions before the rewarded
tick by 0.9, 0.95 and 0.97, newest first; -1 divides by them. The value of an RLA is (100 - mean weight into it) / 100.
Weights stay between 10 and 1000, equally many rewards from 100 in both directions.
"""

import math
from collections.abc import Collection, Iterable, Mapping

from kurt2rt.core.reinforcement.eligibility_trace import EligibilityTrace
from kurt2rt.core.reinforcement.rule import CreditUpdate
from kurt2rt.core.reinforcement.settings import ReinforcementSettings
from kurt2rt.core.reinforcement.value_history import ValueHistory
from kurt2rt.core.rla.credit import Credit
from kurt2rt.core.rla.statistics import Statistics

FIRST_WEIGHT = 100.0
_LEAST_WEIGHT, _MOST_WEIGHT = 10.0, 1000.0

_Edges = dict[int, float]
"""Weights of the used edges into one RLA, by predecessor."""


class EdgeWeights:
    """Reinforcement rule on edge weights (ReinforcementRule)."""

    def __init__(self, settings: ReinforcementSettings) -> None:
        self._factors = settings.factors
        self._history = ValueHistory[_Edges]()
        self._before: int | None = None

    def update(self, rla_id: int | None, tick: int) -> None:  # noqa: ARG002 - only transitions count
        """Learn from one tick: a change of the RLA creates an edge.

        `rla_id`: answering RLA; None at standstill or outside its radius.
        """
        if rla_id == self._before:
            return
        if rla_id is not None and self._before is not None:
            self._history.present.setdefault(rla_id, {}).setdefault(self._before, FIRST_WEIGHT)
        self._before = rla_id

    def credits_for(self, value: int, trace: EligibilityTrace) -> tuple[Credit, ...]:
        """Return the changes of weights that a reward of -1 or +1 would make; nothing is changed.

        A credit is a share of the first weight. A lower weight gives a positive credit.
        """
        present = self._history.present
        return tuple(
            Credit(rla_id, (present.get(rla_id, {}).get(before, FIRST_WEIGHT) - edges[before]) / FIRST_WEIGHT, before)
            for rla_id, edges in self._weights_after(value, trace).items()
            for before in edges
            if edges[before] != present.get(rla_id, {}).get(before)
        )

    def learn(self, value: int, trace: EligibilityTrace) -> None:
        """Multiply (`value` +1) or divide (-1) the weights of the trace's transitions by their factors."""
        self._history.present.update(self._weights_after(value, trace))

    def apply_credits(self, updates: Iterable[CreditUpdate], sign: int) -> None:
        """Apply (`sign` +1) or take back (-1) credits, each on the edge into its RLA.

        A credit of an old journal names no edge and changes all edges into its RLA.
        """
        for (rla_id, change, before), depth in updates:
            edges = self._history.get(rla_id, depth)
            if edges is None and (before is None or sign < 0):
                continue
            edges = dict(edges or {})
            if before is not None and sign > 0:
                edges.setdefault(before, FIRST_WEIGHT)
            for edge in edges if before is None else edges.keys() & {before}:
                edges[edge] = _bounded(edges[edge] - sign * change * FIRST_WEIGHT)
            self._history.set(rla_id, depth, edges)

    def value(self, rla_id: int) -> float:
        """Return the value of an RLA by the weights of the edges into it, a score of -1 to 1; 0 without rewards."""
        return max(-1.0, min(1.0, _value(self._history.present.get(rla_id))))

    def depth(self, rla_id: int) -> int:
        """Return the number of earlier actions of an RLA that an undo can restore."""
        return self._history.depth(rla_id)

    def reset(self, rla_id: int) -> None:
        """Start with no edges into an RLA that got another action."""
        self._history.reset(rla_id)

    def restore_previous(self, rla_id: int) -> None:
        """Restore the edges into an RLA that got its previous action back."""
        self._history.restore_previous(rla_id)

    def archive(self, rla_id: int) -> None:
        """Keep the edges into a deleted RLA for an undo; drop the edges out of it."""
        self._history.reset(rla_id)
        self._drop_edges_from(rla_id)

    def discard(self, rla_id: int) -> None:
        """Drop all edges of an RLA whose creation was undone."""
        self._history.discard(rla_id)
        self._drop_edges_from(rla_id)

    @property
    def values(self) -> Mapping[int, float]:
        """Empty: this rule has no values."""
        return {}

    @property
    def edge_weights(self) -> Mapping[tuple[int, int], float]:
        """Weights of all used edges."""
        return {
            (before, after): weight
            for after, edges in self._history.present.items()
            for before, weight in edges.items()
        }

    def restore(self, saved: Statistics, only: Collection[int] | None = None) -> None:
        """Restore saved weights of the edges into all RLAs, or into `only` some."""
        edges_into: dict[int, _Edges] = {}
        for (before, after), weight in saved.edge_weights.items():
            edges_into.setdefault(after, {})[before] = _bounded(weight)
        self._history.restore(edges_into, only)

    def _drop_edges_from(self, rla_id: int) -> None:
        for edges in self._history.present.values():
            edges.pop(rla_id, None)
        if self._before == rla_id:
            self._before = None

    def _weights_after(self, value: int, trace: EligibilityTrace) -> dict[int, _Edges]:
        """Return the edges into each RLA of the trace after a reward of `value`."""
        changed: dict[int, _Edges] = {}
        for (before, after), factor in zip(trace.transitions, self._factors, strict=False):
            edges = changed.setdefault(after, dict(self._history.present.get(after, {})))
            weight = edges.get(before, FIRST_WEIGHT)
            edges[before] = _bounded(weight * factor if value > 0 else weight / factor)
        return changed


def _bounded(weight: float) -> float:
    return max(_LEAST_WEIGHT, min(_MOST_WEIGHT, weight))


def _value(edges: _Edges | None) -> float:
    """Return the value without limits."""
    return (FIRST_WEIGHT - math.fsum(edges.values()) / len(edges)) / FIRST_WEIGHT if edges else 0.0
