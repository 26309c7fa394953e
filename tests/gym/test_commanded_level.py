"""The commanded level drives the newest command, and starts a finished action again."""

import math

import numpy as np

from behaviors.motor_primitive import MotorPrimitive
from hal.robot import STANDSTILL, SensorReadings, WheelSpeeds
from kurt2rt.core.decision.decision import Decision, DecisionCause
from kurt2rt.core.perception.perception import Situation
from kurt2rt.gym.bus_drive import CommandedLevel

SITUATION = Situation(np.zeros(72), history_frozen=False)
READINGS = SensorReadings(0.0, (0,) * 18, 0.0, 0, 0, 0.0, 0, math.inf)
AHEAD = WheelSpeeds(0.3, 0.3)


class TwoSteps:
    """Action that is finished after two ticks."""

    lost = False

    def __init__(self) -> None:
        self.left = 2

    @property
    def finished(self) -> bool:
        return self.left == 0

    def start(self) -> None:
        self.left = 2

    def step(self, readings: SensorReadings) -> WheelSpeeds:  # noqa: ARG002 - it counts only
        if self.finished:
            return STANDSTILL
        self.left -= 1
        return AHEAD


def decide(level: CommandedLevel, blocked: DecisionCause | None = None) -> Decision:
    return level.decide(SITUATION, READINGS, blocked)


def test_level_drives_the_command_unless_it_is_blocked() -> None:
    level = CommandedLevel({"on": MotorPrimitive(AHEAD)})
    level.command("on")
    assert (decide(level).wheel_speeds, decide(level).action) == (AHEAD, "on")
    blocked = decide(level, DecisionCause.STOPPED)
    assert (blocked.wheel_speeds, blocked.cause, blocked.driving) == (STANDSTILL, DecisionCause.STOPPED, False)
    assert decide(level).wheel_speeds == AHEAD


def test_level_goes_on_with_an_unfinished_action() -> None:
    action = TwoSteps()
    level = CommandedLevel({"twice": action})
    level.command("twice")
    decide(level)
    level.command("twice")
    decide(level)
    assert action.finished
