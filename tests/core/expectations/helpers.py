"""Small systems whose RLAs end where the tests say."""

import numpy as np

from kurt2rt.core.expectations.expectations import End, Expectations, Surprise, affected_rla
from kurt2rt.core.rla.condition import Metric, Space
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import BASIC, MID
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import Expectation
from tests.core.rla.helpers import created


class Small:
    """Three RLAs in a plane, or over three symbols, and what is expected of them."""

    def __init__(self, metric: Metric = "euclidean", saved: dict[int, Expectation] | None = None) -> None:
        self.level = BASIC if metric == "euclidean" else MID
        dimensions, radius = (2, 10.0) if metric == "euclidean" else (3, 2.0)
        self.space = Space(dimensions, radius, metric=metric)
        self.system = RlaSystem(2, 10.0, others={} if metric == "euclidean" else {MID: self.space})
        for rla_id in (1, 2, 3):
            self.system.apply(created(rla_id, (float(rla_id),) * dimensions, level=self.level))
        self.transitions: dict[tuple[int, int], int] = {}
        self.expectations = Expectations(self.level, self.system, self.space, self.transitions, saved)

    def ends(self, rla_id: int, follow_up: int, *situation: float, ticks: int = 10) -> Surprise | None:
        """One end of an RLA."""
        surprise = self.expectations.learn(End(rla_id, follow_up, np.array(situation), ticks))
        self.transitions[rla_id, follow_up] = self.transitions.get((rla_id, follow_up), 0) + 1
        return surprise

    def happens(self, event: TeachingEvent) -> int | None:
        """Apply a lesson to system and expectations."""
        self.system.apply(event)
        changed = affected_rla(event, self.system.history)
        if changed is not None:
            self.expectations.forget(changed)
        return changed

    def expected(self, rla_id: int) -> Expectation:
        """Return the expectation of an RLA that has ended."""
        expectation = self.expectations.get(rla_id)
        assert expectation is not None
        return expectation
