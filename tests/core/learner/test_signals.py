"""Rewards of a learner that is no RLA system: they reach it with what it did, and an undo takes them back."""

from collections.abc import Iterator, Sequence

import anyio
import numpy as np
import pytest

from hal.kurt2_settings import load_kurt2
from kurt2rt.core.event_store import InMemoryEventStore
from kurt2rt.core.learner.learner import Driven, LearnerSetting, Signal
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.outcome import Outcome, RefusalCode, ResultCode
from kurt2rt.core.task_settings import load_task
from kurt2rt.core.teaching.commands import Command, Reward, Teach
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runtime import RuntimeOptions, build_runtime
from simbridge.simulation import Kurt2SimulationFactory
from tests.core.learner.helpers import SETTING, Dog, Parrot, label

ROBOT = load_kurt2()


class Listener(Dog):
    """Dog that keeps its rewards."""

    def __init__(self, setting: LearnerSetting) -> None:
        super().__init__(setting)
        self.rewards: list[tuple[Sequence[Driven], int]] = []

    def signal(self, driven: Sequence[Driven], value: int) -> None:
        self.rewards.append((driven, value))


class RewardedRobot:
    """Simulated robot that decides by a learner, and its teacher."""

    def __init__(self, kind: type[Parrot]) -> None:
        self._simulation = Kurt2SimulationFactory(ROBOT).open("a", 4, "rewards")
        self.team = LearnerTeam("dog", kind, SETTING._replace(actions=("forward", "spin_left")), ("",))
        self.store = InMemoryEventStore()
        self.runtime = build_runtime(
            self._simulation.robot,
            ROBOT,
            load_task("wall_following"),
            (),
            self.store,
            LockstepClock(self._simulation.step),
            RuntimeOptions(learners=self.team),
        )
        self.records: list[TickRecord] = []

    def go_on(self, ticks: int, *commands: Command) -> TickRecord:
        for command in commands:
            self.runtime.inbox.put(command)
        anyio.run(self.runtime.scheduler.run, ticks, self.records.append)
        return self.records[-1]

    def outcome(self, command: Command) -> Outcome:
        return self.go_on(1, command).results[0].outcome

    def close(self) -> None:
        self._simulation.close()


@pytest.fixture
def robot() -> Iterator[RewardedRobot]:
    robot = RewardedRobot(Listener)
    yield robot
    robot.close()


def test_reward_tells_what_drove_in_the_second_before(robot: RewardedRobot) -> None:
    robot.go_on(20)
    robot.go_on(30, Teach("t-1", "Ann", "spin_left"))
    meant = robot.go_on(1)
    robot.go_on(40)
    assert robot.outcome(Reward("r-1", "Ann", -1, meant.tick)) == Outcome.of(ResultCode.LEARNER_PUNISHED)
    learner = robot.team.learner("")
    assert isinstance(learner, Listener)
    ((driven, value),) = learner.rewards
    assert value == -1
    assert [each.age_ticks for each in driven] == list(range(31))  # it stood and asked before
    assert {each.action for each in driven} == {"spin_left"}
    assert np.array_equal(driven[0].situation, meant.situation.vector)
    assert not driven[0].situation.flags.writeable
    assert len(robot.store.events) == 1  # the journal has the answer alone


def test_reward_of_a_robot_that_stood_is_refused(robot: RewardedRobot) -> None:
    stood = robot.go_on(20)
    assert robot.outcome(Reward("r-1", "Ann", 1, stood.tick)) == Outcome(RefusalCode.NO_RLA_DROVE)
    assert robot.team.lessons == ()


def test_reward_is_refused_by_a_learner_without_signal() -> None:
    robot = RewardedRobot(Parrot)
    robot.go_on(20)
    robot.go_on(10, Teach("t-1", "Ann", "spin_left"))
    assert robot.outcome(Reward("r-1", "Ann", 1)) == Outcome(RefusalCode.NO_SIGNALS)
    robot.close()


def test_undo_of_a_signal_teaches_the_other_lessons_again() -> None:
    team = LearnerTeam("dog", Dog, SETTING, ("",))
    team.teach(label(3.0, "a", "t-1"))
    team.teach(Signal((Driven(np.array([3.0]), "c", 0),), "", 1, "r-1"))
    assert team.decide("", np.array([3.0]), taught=True) == "c"
    assert [each.command_id for each in team.labels] == ["t-1"]
    team.undo("r-1")
    assert team.decide("", np.array([3.0]), taught=True) == "a"
