"""A basic level over a situation of one number, whose actions tell how often they began."""

from typing import Any

import numpy as np
import pytest

from hal.robot import SensorReadings, WheelSpeeds
from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.decision.decision import ActiveBehaviour, Decision, DecisionCause
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla_system import RlaSystem

RADIUS = 10.0
MINIMUM_TICKS = 5


class Counted:
    """An action that drives faster the longer it is active: 1 mm/s, 2 mm/s, 3 mm/s ..."""

    def __init__(self) -> None:
        self.starts = 0
        self.steps = 0
        self.finished = False
        self.lost = False

    def start(self) -> None:
        self.starts += 1
        self.steps = 0

    def step(self, readings: SensorReadings) -> WheelSpeeds:  # noqa: ARG002 - it looks at nothing
        self.steps += 1
        return WheelSpeeds(0.001 * self.steps, 0.001 * self.steps)


class SmallLevel:
    """A BasicLevel with the actions a, b and c, and one tick in a call."""

    def __init__(self, *events: TeachingEvent, behaviours: tuple[str, ...] = ("",)) -> None:
        self.actions = {name: Counted() for name in "abc"}
        system = RlaSystem(1, RADIUS)
        system.apply_all(events)
        self.wanted = ActiveBehaviour(behaviours)
        self.level = BasicLevel(system, self.actions, MINIMUM_TICKS, self.wanted)

    def at(self, place: float, stand_because: DecisionCause | None = None) -> Decision:
        return self.level.decide(situation(place), sensed(), stand_because)


def situation(place: float) -> Situation:
    return Situation(np.array([place]), history_frozen=False)


def sensed(*infrared_counts: int) -> SensorReadings:
    return SensorReadings(0.0, infrared_counts, 0.0, 0, 0, 0.0, 0, 0.0)


def runs_away(monkeypatch: pytest.MonkeyPatch, **wrong: Any) -> None:
    """Let the basic level decide something wrong from now on."""
    decide = BasicLevel.decide

    def decides(level: BasicLevel, *words: Any) -> Decision:
        return decide(level, *words)._replace(**wrong)

    monkeypatch.setattr(BasicLevel, "decide", decides)
