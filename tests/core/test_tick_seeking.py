"""The whole tick with a mid level of places: names, goals, plans, and what goes before them."""

import math
from collections.abc import Sequence

import pytest

from hal.robot import STANDSTILL
from kurt2rt.core.decision.decision import DecisionCause, GoalStatus, PlanStep
from kurt2rt.core.decision.goal import Goal, NamedGoal
from kurt2rt.core.outcome import Outcome, RefusalCode, ResultCode
from kurt2rt.core.rla.events import SituationNamed, TeachingEvent
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.teaching.commands import (
    BeAt,
    Correct,
    NameSituation,
    Pursue,
    ReplaceAction,
    Seek,
    Stop,
    StopSeeking,
    Teach,
    Undo,
)
from kurt2rt.core.tick_record import TickRecord
from tests.core.test_tick_with_mid_level import OPEN, STREETS, WALL, Town, told

PLACES = STREETS.model_copy(update={"mid": "places"})
QUARTERS = {"straight_on": 0, "turn_left": 1, "turn_right": -1}
DOOR = NamedGoal("door")


class Block(Town):
    """Streets round a block: four left turns lead back to where the first one began."""

    def __init__(self, events: Sequence[TeachingEvent] | None = None) -> None:
        super().__init__(events, task=PLACES)
        self.said = len(self.taught_before)  # ids of commands are not given twice
        self.street()

    def go(self, behaviour: str | None = None) -> TickRecord:
        """Drive through the next junction by `behaviour`, else by the active behaviour, until the robot notices it."""
        quarters = QUARTERS[self.runtime.active_behaviour.behaviour if behaviour is None else behaviour]
        passed = self.passed
        self._go(WALL, 0.5, 0.0)
        self._go(OPEN, 0.6, quarters * math.pi / 2)
        while self.passed == passed:
            record = self._go(WALL, 0.02, 0.0)
        return record

    def say(self, command: type, *what: object) -> TickRecord:
        """Run a tick with a command of Ann."""
        self.said += 1
        return self.run(command(f"ann-{self.said}", "Ann", *what))

    def teach(self, action: str, *, next_to: bool = False) -> None:
        outcome = told(self.say(Teach, action, None, MID, next_to))
        assert outcome.accepted, outcome

    def seek(self, goal: Goal = DOOR) -> TickRecord:
        return self.say(Seek, goal)

    def plan(self) -> PlanStep:
        """Return the status of the goal when its plan is settled."""
        while True:
            step = self.run().decision.plan
            assert step is not None
            if step.course is not GoalStatus.PLANNING:
                return step


@pytest.fixture
def block() -> Block:
    """Led round the block once, to the left; what comes behind the second corner is called the door."""
    town = Block()
    for corner in range(4):
        if corner == 2:
            town.say(NameSituation, "door")
        town.teach("turn_left")
        town.go()
    return town


def test_seek_while_standing_stands_until_the_plan_is_ready(block: Block) -> None:
    block.say(NameSituation, "here")
    block.seek(NamedGoal("here"))
    record = block.seek(DOOR)
    for _ in range(2):
        plan = record.decision.plan
        assert plan is not None
        assert (plan.course, record.decision.wheel_speeds) == (GoalStatus.PLANNING, STANDSTILL)
        record = block.run()
    assert block.plan().course is GoalStatus.UNDER_WAY
    assert block.run().decision.driving


def test_late_plan_applies_after_the_next_junction(block: Block) -> None:
    block.say(NameSituation, "here")
    block.teach("straight_on", next_to=True)
    block.say(Pursue, "straight_on")
    block.go()
    block.teach("straight_on")
    block.say(NameSituation, "yard")
    block.say(BeAt, "here")
    block.run()
    block.robot.left_m = block.robot.right_m = 0.2  # so fast that it is far on before the plan stands
    block.seek(NamedGoal("yard"))
    step = block.plan()
    block.robot.left_m = block.robot.right_m = 0.0
    assert (step.course, step.rla_id) == (GoalStatus.UNDER_WAY, None)
    assert block.run().behaviour == "turn_left"
    block.go()
    assert block.plan().behaviours == ("turn_left", "turn_left", "turn_left", "straight_on")


def test_lesson_about_places_restarts_the_plan_at_intervals(block: Block) -> None:
    block.say(NameSituation, "here")
    block.seek(NamedGoal("here"))
    block.seek(DOOR)
    changes = 0
    while (step := block.run().decision.plan) is not None and step.course is GoalStatus.PLANNING:
        changes += 1
        block.teach(("straight_on", "turn_right")[changes % 2], next_to=True) if changes < 3 else None
    assert 2 < changes < 30
    assert block.plan().rla_id == 4


def test_a_name_that_is_given_again_is_sought_where_it_is_now(block: Block) -> None:
    block.seek(DOOR)
    assert len(block.plan().behaviours) == 2
    block.go()
    block.say(NameSituation, "door", None)  # here, where the first way leads
    step = block.plan()
    assert step.course is GoalStatus.ARRIVED


def test_a_goal_whose_name_is_undone_is_given_up_with_words(block: Block) -> None:
    block.seek(DOOR)
    block.plan()
    (name,) = (event.origin.command_id for event in block.notebook.events if isinstance(event, SituationNamed))
    record = block.say(Undo, name)
    step = block.plan()
    assert "'door'" in step.says
    assert (step.course, record.decision.wheel_speeds) == (GoalStatus.NO_WAY, STANDSTILL)
    block.go()
    block.say(NameSituation, "door")
    assert block.plan().course is GoalStatus.ARRIVED
    assert told(block.say(StopSeeking)).accepted
    assert block.run().decision.driving


def test_place_without_name_is_named_by_its_rla() -> None:
    town = Block()
    town.teach("turn_left")
    again = Block([*town.taught_before, *town.notebook.events])
    assert told(again.say(BeAt, "door")) == Outcome.of(RefusalCode.NO_PLACE, name="door", known=())
    assert told(again.say(BeAt, "RLA 4")) == Outcome.of(ResultCode.LOCATED, name="RLA 4")
    assert not again.run().decision.asking


def test_a_stop_goes_before_all(block: Block) -> None:
    block.seek()
    assert block.say(Stop).decision.cause is DecisionCause.STOPPED
    late = block.run(Seek("late", "Ann", DOOR, block.tick - 1))
    assert not told(late).accepted
    assert late.decision.cause is DecisionCause.STOPPED


def test_late_goal_does_not_replace_a_newer_one(block: Block) -> None:
    block.seek()
    seen = block.tick
    block.run()
    assert told(block.run(StopSeeking("new", "Ann", block.tick))).accepted
    late = block.run(Seek("late", "Ann", DOOR, seen))
    assert told(late) == Outcome(RefusalCode.GOAL_SINCE)
    assert late.decision.plan is None
    assert told(block.run(Seek("again", "Ann", DOOR, block.tick))).accepted


def test_location_from_before_a_junction_is_refused(block: Block) -> None:
    seen = block.tick
    block.go()
    assert block.runtime.mid is not None
    here = block.runtime.mid.vector
    late = block.run(BeAt("late", "Ann", "door", seen))
    assert told(late) == Outcome(RefusalCode.JUNCTION_PASSED)
    assert block.runtime.mid.vector is here
    assert told(block.run(BeAt("again", "Ann", "door", block.tick))).accepted


def test_one_goal_is_planned_for_in_a_tick_however_many_are_sent(block: Block) -> None:
    record = block.run(*(Seek(f"seek-{number}", "Ann", DOOR) for number in range(200)))
    assert [result.accepted for result in record.results] == [True] + [False] * 199
    assert record.results[-1].outcome == Outcome(RefusalCode.GOAL_IN_SAME_TICK)
    assert told(block.seek()).accepted


def test_correction_to_a_known_way_selects_it_without_a_lesson(block: Block) -> None:
    block.teach("straight_on", next_to=True)
    assert block.run().behaviour == "turn_left"
    record = block.say(Correct, "straight_on", None, MID)
    assert told(record) == Outcome.of(ResultCode.RLA_CONFLICTS, rla=8, level=MID, action="straight_on")
    assert block.ways == {4: "turn_left", 5: "turn_left", 6: "turn_left", 7: "turn_left", 8: "straight_on"}
    assert record.mid is not None
    assert (record.behaviour, record.mid.rla_id) == ("straight_on", 8)
    refused = block.say(ReplaceAction, 4, "straight_on")
    assert told(refused) == Outcome.of(RefusalCode.SAYS_SO, rla=8, level=MID, action="straight_on", delete=4)
