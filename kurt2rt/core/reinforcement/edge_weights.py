"""Weights on the edges of the RLA network (Illerhues and Goerke 2007): the smaller, the better what follows what.

Each edge that was used begins at 100. Praise multiplies the weights of the last three transitions before the tick that
is meant by 0.9, 0.95 and 0.97, newest first; blame divides by them. An RLA is worth by how much the edges into it have
fallen: (100 - their mean) / 100.

A weight stays between 10 and 1000, as many praises from 100 as blames: what was blamed for an hour is healed by no more
praise than it took blame to get there.
"""

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
"""Weights of the used edges into one RLA, by the RLA before it."""


class EdgeWeights:
    """Weights of the edges, and worths by them."""

    def __init__(self, settings: ReinforcementSettings) -> None:
        self._factors = settings.factors
        self._history = ValueHistory[_Edges]()
        self._before: int | None = None

    def update(self, rla_id: int | None, tick: int) -> None:  # noqa: ARG002 - what follows what is all that counts
        """Take in one tick: another RLA than before makes an edge used."""
        if rla_id == self._before:
            return
        if rla_id is not None and self._before is not None:
            self._history.present.setdefault(rla_id, {}).setdefault(self._before, FIRST_WEIGHT)
        self._before = rla_id

    def credits_for(self, value: int, trace: EligibilityTrace) -> tuple[Credit, ...]:
        """What each weight changes by, as a share of the first one: falling weights are worth more."""
        present = self._history.present
        return tuple(
            Credit(rla_id, (present.get(rla_id, {}).get(before, FIRST_WEIGHT) - edges[before]) / FIRST_WEIGHT, before)
            for rla_id, edges in self._weights_after(value, trace).items()
            for before in edges
            if edges[before] != present.get(rla_id, {}).get(before)
        )

    def learn(self, value: int, trace: EligibilityTrace) -> None:
        """Multiply or divide the weights of the last transitions."""
        self._history.present.update(self._weights_after(value, trace))

    def apply_credits(self, bookings: Iterable[CreditUpdate], sign: int) -> None:
        """Change the edge that a credit is of; in old journals it is of an RLA, and shifts all edges into that one."""
        for (rla_id, change, before), depth in bookings:
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
        """From -1 to 1; 0 for one that nothing was ever said of."""
        return max(-1.0, min(1.0, _worth(self._history.present.get(rla_id))))

    def depth(self, rla_id: int) -> int:
        """How many actions it has had before."""
        return self._history.depth(rla_id)

    def reset(self, rla_id: int) -> None:
        """The edges into it begin anew."""
        self._history.reset(rla_id)

    def restore_previous(self, rla_id: int) -> None:
        """The edges into it as they were."""
        self._history.restore_previous(rla_id)

    def archive(self, rla_id: int) -> None:
        """The edges into it wait; those out of it are gone, for nothing could ever heal them."""
        self._history.reset(rla_id)
        self._drop_edges_from(rla_id)

    def discard(self, rla_id: int) -> None:
        """All its edges are gone."""
        self._history.discard(rla_id)
        self._drop_edges_from(rla_id)

    @property
    def values(self) -> Mapping[int, float]:
        """None."""
        return {}

    @property
    def edge_weights(self) -> Mapping[tuple[int, int], float]:
        """Weights of all edges that were used."""
        return {
            (before, after): weight
            for after, edges in self._history.present.items()
            for before, weight in edges.items()
        }

    def restore(self, saved: Statistics, only: Collection[int] | None = None) -> None:
        """Weights as they were saved: of the edges into each RLA."""
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
        """Edges into each RLA that the signal means, after it."""
        changed: dict[int, _Edges] = {}
        for (before, after), factor in zip(trace.transitions, self._factors, strict=False):
            edges = changed.setdefault(after, dict(self._history.present.get(after, {})))
            weight = edges.get(before, FIRST_WEIGHT)
            edges[before] = _bounded(weight * factor if value > 0 else weight / factor)
        return changed


def _bounded(weight: float) -> float:
    return max(_LEAST_WEIGHT, min(_MOST_WEIGHT, weight))


def _worth(edges: _Edges | None) -> float:
    """Not clipped, so that credits add up."""
    return (FIRST_WEIGHT - sum(edges.values()) / len(edges)) / FIRST_WEIGHT if edges else 0.0
