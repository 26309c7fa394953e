"""RLA system as a learner: the rules of the lesson builder, without what a learner is not told."""

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.learner.label_learner import pack, unpack
from kurt2rt.core.learner.learner import LearnerSetting, Why
from kurt2rt.core.rla.events import ActionReplaced, RlaCreated
from kurt2rt.core.rla.rla import Origin, Phase, Rla
from kurt2rt.core.rla.rla_system import RlaSystem

_ESTIMATED = (Why.LATE, Why.HOLD, Why.SHOWN)
"""Occasions on which nothing is learned if the RLAs say this action there already."""


class RlaLearner:
    """Nearest RLA within R; a correction inserts beyond a small share of R, else it replaces.

    What the robot's own RLA level has besides: doubt, guesses that are passed over, and holds that yield.
    """

    def __init__(self, setting: LearnerSetting) -> None:
        self.setting = setting
        self._lessons = 0
        self.system = self._empty()

    def decide(self, situation: NDArray[np.float64], *, taught: bool) -> str | None:
        """Return the action of the RLA nearest to a situation (d,); None outside R, or its share while `taught`."""
        self.system.radius_share = self.setting.ask_radius_fraction if taught else 1.0
        match = self.system.match(situation)
        return match.rla.action if match is not None and match.known else None

    def lesson(self, situation: NDArray[np.float64], action: str, why: Why) -> None:
        """Insert an RLA at a situation (d,), or replace the action of the one that is near."""
        if why in _ESTIMATED and self.decide(situation, taught=True) == action:
            return
        nearest = self.system.match(situation)
        if nearest is not None:
            share = 0.0 if why is Why.ANSWER else self.setting.insert_radius_fraction
            if nearest.distance <= share * self.system.whole_radius(nearest.rla):
                if nearest.rla.action != action:
                    self.system.apply(
                        ActionReplaced(nearest.rla.rla_id, action, nearest.rla.action, self._next_origin())
                    )
                return
        self.insert(tuple(situation.tolist()), action)

    def snapshot(self) -> bytes:
        """Return conditions and actions of the RLAs."""
        rlas = self.system.rlas
        conditions = np.array([rla.condition for rla in rlas]).reshape(len(rlas), self.setting.dimensions)
        return pack(conditions, [rla.action for rla in rlas])

    def restore(self, data: bytes) -> None:
        """Hold the RLAs of a snapshot. Raises ValueError for bytes that are none."""
        conditions, actions = unpack(data, self.setting.dimensions)
        self.system = self._empty()
        for condition, action in zip(conditions, actions, strict=True):
            self.insert(tuple(condition.tolist()), action)

    def insert(self, condition: tuple[float, ...], action: str) -> None:
        """Add an RLA with a condition of d numbers."""
        self.system.apply(RlaCreated(Rla(self.system.next_id, condition, action, None, self._next_origin())))

    def _empty(self) -> RlaSystem:
        return RlaSystem(self.setting.dimensions, self.setting.radius, self.setting.weights)

    def _next_origin(self) -> Origin:
        self._lessons += 1
        return Origin(f"lesson-{self._lessons}", "", Phase.SUPERVISED, 0)
