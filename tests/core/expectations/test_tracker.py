"""Expectations in a slow lesson: the basic level learns nothing, and its durations begin again at full speed."""

import numpy as np

from hal.robot import WheelSpeeds
from kurt2rt.core.decision.decision import Decision, DecisionCause
from kurt2rt.core.expectations.tracker import ExpectationTracker
from kurt2rt.core.perception.perception import Situation
from tests.core.expectations.helpers import Small


class Tracked:
    """Robot that drives by one RLA after the other, ten ticks each."""

    def __init__(self) -> None:
        self.tracker = ExpectationTracker(Small().system, None, {})
        self._tick = 0

    def drives(self, *rla_ids: int, slow: bool) -> None:
        for rla_id in rla_ids:
            decision = Decision(WheelSpeeds(0.3, 0.3), DecisionCause.RLA, "a", rla_id, None)
            for _ in range(10):
                self._tick += 1
                situation = Situation(np.array([float(rla_id), 0.0]), history_frozen=False)
                self.tracker.update(self._tick, decision, situation, "", driving=True, slow=slow)


def test_update_slow_lesson_teaches_no_expectation() -> None:
    robot = Tracked()
    robot.drives(1, 2, 3, 1, slow=True)
    assert robot.tracker.snapshot() == {}


def test_update_counts_from_the_begin_of_full_speed() -> None:
    robot = Tracked()
    robot.drives(1, slow=True)
    robot.drives(1, 2, slow=False)
    learned = robot.tracker.snapshot()
    assert {rla_id: (each.count, each.ticks) for rla_id, each in learned.items()} == {1: (1, 10.0)}
