"""The tick with a learner that is no RLA system: taught, undone, failing, slow, and asked why."""

from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import NDArray

from hal.guard_reason import GuardReason
from hal.robot import STANDSTILL
from kurt2rt.core.decision.decision import DecisionCause, StandReason
from kurt2rt.core.decision.standing import reason_text
from kurt2rt.core.learner.learner import LearnerSetting, Why
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.outcome import RefusalCode
from kurt2rt.core.teaching.commands import Command, DeleteRla, HoldAction, ReplaceAction, Reward, Teach, Undo
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runs.explain.collect import collect_facts
from kurt2rt.runs.explain.reasons import format_reasons, headline
from tests.core.learner.helpers import SETTING, Parrot
from tests.runs.explain.helpers import Lesson

ACTIONS = ("forward", "spin_left", "spin_right", "teleport")


class StalledClock(LockstepClock):
    """Clock of a computer that a decision can hold up."""

    def stall(self, seconds: float) -> None:
        self._now_s += seconds


class Wayward(Parrot):
    """Parrot that a test can make fail."""

    mischief = ""
    robot: "TaughtRobot"

    def decide(self, situation: NDArray[np.float64], *, taught: bool) -> str | None:
        if self.mischief == "raises":
            raise ZeroDivisionError("no such number")
        if self.mischief == "slow":
            self.robot.clock.stall(0.05)
        return super().decide(situation, taught=taught)


class TaughtRobot(Lesson):
    """Simulated robot that decides by a parrot, and its teacher."""

    def __init__(self) -> None:
        self.team = LearnerTeam("parrot", self._make, SETTING._replace(actions=ACTIONS), ("",))
        super().__init__(seed=4, clock=StalledClock, learners=self.team)

    def _make(self, setting: LearnerSetting) -> Wayward:
        self.parrot = Wayward(setting)
        self.parrot.robot = self
        return self.parrot

    def why(self) -> str:
        facts = collect_facts(self.runtime, self.records[-1], lambda command_id: command_id)
        return " ".join((f"{headline(facts)}.", *format_reasons(facts)))


@pytest.fixture
def robot() -> Iterator[TaughtRobot]:
    robot = TaughtRobot()
    yield robot
    robot.close()


def test_undo_of_a_hold_takes_all_of_its_labels_back(robot: TaughtRobot) -> None:
    robot.go_on(20)
    robot.go_on(100, Teach("t-1", "Ann", "spin_left"))
    for _ in range(10):
        robot.go_on(10, HoldAction("Ann", robot.records[-1].tick, 1, "spin_left"))
    robot.go_on(50)
    held = [each.why for each in robot.team.labels[1:]]
    assert held == [Why.HOLD] * len(held)
    assert len(held) > len(robot.notebook.events) - 1 > 0  # most change no RLA
    robot.go_on(1, Undo("u-1", "Ann"))
    assert [each.command_id for each in robot.team.labels] == ["t-1"]


@pytest.mark.parametrize(
    ("command", "code"),
    [
        (DeleteRla("d-1", "Ann", 1), RefusalCode.NO_RLA_DECIDES),
        (ReplaceAction("r-1", "Ann", 1, "forward"), RefusalCode.NO_RLA_DECIDES),
        (Reward("r-1", "Ann", 1), RefusalCode.NO_SIGNALS),
    ],
)
def test_command_for_rlas_alone_is_refused(robot: TaughtRobot, command: Command, code: RefusalCode) -> None:
    robot.go_on(20)
    robot.go_on(1, Teach("t-1", "Ann", "spin_left"))
    assert robot.go_on(1, command).results[0].outcome.code is code


def test_failed_learner_stands_and_says_it(robot: TaughtRobot) -> None:
    robot.go_on(20)
    assert robot.go_on(30, Teach("t-1", "Ann", "spin_left")).decision.driving
    robot.parrot.mischief = "raises"
    stands = robot.go_on(1)
    assert (stands.decision.cause, stands.decision.wheel_speeds) == (DecisionCause.LEARNER_FAILED, STANDSTILL)
    assert reason_text(stands.standing) == "its learner failed: parrot: ZeroDivisionError: no such number"
    assert "The learner that decides failed" in robot.why()
    robot.parrot.mischief = ""
    assert robot.go_on(50).guard_result.wheel_speeds == STANDSTILL  # it is not asked again


def test_guard_stops_a_slow_learner(robot: TaughtRobot) -> None:
    robot.go_on(20)
    assert robot.go_on(30, Teach("t-1", "Ann", "spin_left")).guard_result.wheel_speeds != STANDSTILL
    robot.parrot.mischief = "slow"
    late = robot.go_on(1)
    assert late.decision.driving
    assert late.guard_result.wheel_speeds == STANDSTILL
    assert GuardReason.COMMAND_TOO_OLD in late.guard_result.reasons
    assert robot.go_on(100).standing.reason is StandReason.LATE  # most of them are missed
