"""Rewards, the critic and what comes of them, through the whole tick of the shipped robot."""

from collections.abc import Sequence
from typing import Any

import pytest

from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.decision.standing import STARTED
from kurt2rt.core.event_store import InMemoryEventStore
from kurt2rt.core.rla.credit import Credit
from kurt2rt.core.rla.events import ActionWithdrawn, Appraised, RlaCreated, RlaRewarded, TeachingEvent
from kurt2rt.core.rla.rla import CRITIC, Origin, Phase
from kurt2rt.core.rla.statistics import VALUES_INCLUDE, Statistics
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.core.teaching.commands import Appraise, Command, Correct, Reward, SetPhase, Teach, Undo
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runtime import RuntimeOptions, build_runtime
from tests.channel.channel_fixture import ROBOT, WideRobot
from tests.core.rla.helpers import created, withdrawn

NEAR, FAR = 400, 50
TASK = load_task("wall_following")


class Drive:
    """The shipped robot, all sensors of which show one count, and one tick in a call."""

    def __init__(
        self,
        events: Sequence[TeachingEvent] = (),
        *,
        task: TaskSettings = TASK,
        robot: WideRobot | None = None,
        **options: Any,
    ) -> None:
        """Begin with what was taught before; `options`: of the runtime."""
        self.robot = robot or WideRobot()
        self.notebook = InMemoryEventStore()
        clock, options_of = LockstepClock(lambda: None), RuntimeOptions(**options)
        self.runtime = build_runtime(self.robot, ROBOT, task, events, self.notebook, clock, options_of)
        self.tick = 0

    def run(self, *commands: Command, ticks: int = 1, counts: int | None = None) -> TickRecord:
        """So many ticks; the first one takes the commands."""
        if counts is not None:
            self.robot.counts = counts
        for command in commands:
            self.runtime.inbox.put(command)
        for _ in range(ticks):
            self.tick += 1
            self.runtime.timer.begin(0.0)
            record = self.runtime.tick.run(self.tick, self.tick * 0.01)
            self.runtime.timer.end()
        return record


@pytest.fixture
def driving() -> Drive:
    """Taught to go forward near things, and to bear left far from them."""
    drive = Drive()
    drive.run(Teach("near", "Ann", "forward"), counts=NEAR)
    drive.run(Teach("far", "Ann", "bear_left"), counts=FAR)
    assert drive.run(counts=NEAR, ticks=20).decision.action == "forward"
    return drive


def test_a_robot_that_the_guard_has_stopped_is_not_blamed(driving: Drive) -> None:
    driving.robot.latched = True
    record = driving.run()
    assert record.guard_result.latched
    result = driving.run(Reward("r-1", "Ann", -1, record.tick)).results[0]
    assert not result.accepted


def test_a_blind_robot_has_neither_circumstances_nor_an_opinion(driving: Drive) -> None:
    assert driving.run().appraisal_features is not None
    driving.run(Appraise("x-1", "Ann", "good"))
    assert driving.run(ticks=10).opinion is not None
    driving.robot.infrared_age_s = 1.0
    record = driving.run()
    assert (record.decision.cause, record.appraisal_features, record.opinion) == (DecisionCause.BLIND, None, None)
    assert not driving.run(Appraise("x-2", "Ann", "bad")).results[0].accepted


def trusting(driving: Drive) -> Drive:
    """Start the robot again, with a critic that thinks ill of what it does near things, and is trusted."""
    driving.run(Appraise("x-1", "Ann", "bad"), ticks=10)
    taught = list(driving.notebook.events)
    tick = 0
    for number in range(30):
        for name, value in (("bad", -1), ("good", 1)):
            tick += 1000  # one signal in some seconds counts
            taught.append(Appraised(name, value, tick, Origin(f"{name}-{number}", "Ann", Phase.CRITIC, tick)))
    restarted = Drive(taught)
    assert restarted.runtime.handler.agreement is not None
    assert restarted.runtime.handler.agreement.trusted
    return restarted


@pytest.mark.deep
def test_phase_5_trusted_critic_makes_undoable_changes(driving: Drive) -> None:
    drive = trusting(driving)
    known = drive.runtime.level.system.knowledge_hash()
    drive.run(counts=NEAR, ticks=500)
    assert drive.notebook.events == []  # before phase 5 it listens
    drive.run(SetPhase("phase", "Ann", Phase.AUTONOMOUS))
    while not drive.notebook.events:
        drive.run()
    event = drive.notebook.events[0]
    assert isinstance(event, RlaCreated)
    assert (event.origin.teacher, event.origin.phase, event.rla.action) == (CRITIC, Phase.AUTONOMOUS, "bear_left")
    assert drive.run().decision.action == "bear_left"
    assert drive.run(Undo("u-1", "Ann")).results[0].accepted
    assert drive.runtime.level.system.knowledge_hash() == known


def test_no_reward_and_no_opinion_moves_a_robot_that_stands(driving: Drive) -> None:
    drive = trusting(driving)
    drive.runtime.handler.control.stop(STARTED)
    drive.run(SetPhase("phase", "Ann", Phase.AUTONOMOUS))
    for number in range(300):
        record = drive.run(Reward(f"r-{number}", "Ann", (-1, 1)[number % 2]), counts=(NEAR, FAR)[number // 150])
        assert record.decision.cause is DecisionCause.STOPPED
        assert record.guard_result.wheel_speeds == (0.0, 0.0)
    assert drive.notebook.events == []


def withdrawn_and_neighbour() -> list[TeachingEvent]:
    """Return the events of an RLA near obstacles whose action was withdrawn, and of a neighbour of its condition."""
    here = Drive().run(counts=NEAR).situation.vector
    return [created(1, tuple(here.tolist()), "forward"), withdrawn(1), created(2, tuple((here + 5.0).tolist()), "back")]


def test_without_teacher_neighbours_answer_for_withdrawn_rla() -> None:
    events = withdrawn_and_neighbour()
    assert Drive(events).run(counts=NEAR).decision.asking
    assert Drive(events, teacher_available=False).run(counts=NEAR).decision.action == "back"
    assert Drive(events[:2], teacher_available=False).run(counts=NEAR).decision.asking


def test_values_continue_from_checkpoint_or_journal_credits() -> None:
    origin = Origin("r-1", "Ann", Phase.REINFORCEMENT, 5)
    events = (created(1, (float(NEAR),) * 72), RlaRewarded(1, -1, 4, origin, (Credit(1, -0.05),)))
    assert Drive(events).runtime.reinforcement.value(1) == -0.05
    saved = Statistics(values={1: -0.08}, numbers={VALUES_INCLUDE: 2.0})
    assert Drive(events, checkpoint=saved).runtime.reinforcement.value(1) == -0.08
    assert Drive(events, checkpoint=Statistics(uses={1: 7})).runtime.reinforcement.value(1) == -0.05


def story(drive: Drive) -> tuple[list[TeachingEvent], Statistics]:
    drive.run(Teach("near", "Ann", "forward"), counts=NEAR)
    drive.run(Teach("far", "Ann", "bear_left"), counts=FAR)
    drive.run(SetPhase("phase", "Ann", Phase.REINFORCEMENT))
    for turn in range(30):
        record = drive.run(counts=(NEAR, FAR, NEAR - 20)[turn % 3], ticks=50)
        drive.run(
            Reward(f"r-{turn}", "Ann", (-1, 1)[turn % 4 == 0], record.tick),
            Appraise(f"x-{turn}", "Ann", ("bad", "neutral", "good")[turn % 3], record.tick - 7),
        )
        if record.decision.asking:
            drive.run(Teach(f"t-{turn}", "Ann", ("back", "forward")[turn % 2]))
        elif turn % 7 == 0:
            drive.run(Correct(f"c-{turn}", "Ann", "spin_left"))
    return drive.notebook.events, drive.runtime.snapshot()


def test_equal_readings_and_commands_give_equal_values() -> None:
    one, again = story(Drive()), story(Drive())
    assert {type(event) for event in one[0]} >= {RlaRewarded, ActionWithdrawn, RlaCreated, Appraised}
    assert one == again
