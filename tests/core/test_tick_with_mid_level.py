"""The whole tick with a mid level: a robot in streets is asked, taught, corrected and overridden about the way."""

import math
from collections.abc import Sequence
from typing import Any

import pytest

from hal.robot import SensorReadings
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.outcome import Field, Outcome, RefusalCode
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import BASIC, CRITIC, MID
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.core.teaching.commands import Command, Correct, Pursue, ReplaceAction, Resume, Stop, Teach, Undo
from kurt2rt.core.tick_record import TickRecord
from tests.channel.channel_fixture import ROBOT, WideRobot
from tests.core.rla.helpers import created, deleted
from tests.core.test_tick_learning import Drive

STREETS = load_task("streets")
ROUTE = STREETS.model_copy(update={"mid": "turns"})
BEHAVIOURS = STREETS.behaviours
WALL, OPEN = 250, 60
"""Counts of all sensors between walls, and where nothing is near."""
STEP_M = 0.02
LENGTH = 12
EVERYWHERE = 1e6
"""Radius of the basic RLAs: whatever is wanted, the basic level knows what to do."""


def basic_knowledge() -> list[TeachingEvent]:
    place = (0.0,) * 72
    return [
        created(number, place, "forward", EVERYWHERE, behaviour=behaviour)
        for number, behaviour in enumerate(BEHAVIOURS, 1)
    ]


class StreetRobot(WideRobot):
    """Robot between walls or in the open; the test turns its wheels, commands do not."""

    def __init__(self) -> None:
        super().__init__()
        self.counts = WALL
        self.left_m = self.right_m = 0.0

    def sense(self, now_s: float) -> SensorReadings:
        per_m = 1 / ROBOT.geometry.metres_per_tick
        left, right = round(self.left_m * per_m), round(self.right_m * per_m)
        return super().sense(now_s)._replace(encoder_left_ticks=left, encoder_right_ticks=right)


class Town(Drive):
    """The shipped robot in streets, and one tick in a call."""

    robot: StreetRobot

    def __init__(
        self, events: Sequence[TeachingEvent] | None = None, *, task: TaskSettings = ROUTE, **options: Any
    ) -> None:
        self.taught_before = basic_knowledge() if events is None else list(events)
        super().__init__(self.taught_before, task=task, robot=StreetRobot(), **options)
        self.passed = 0

    def run(self, *commands: Command, ticks: int = 1, counts: int | None = None) -> TickRecord:
        record = super().run(*commands, ticks=ticks, counts=counts)
        self.passed += record.mid is not None and record.mid.event is not None
        return record

    def street(self, way_m: float = 0.4) -> TickRecord:
        return self._go(WALL, way_m, 0.0)

    def junction(self, quarters: int = 0) -> TickRecord:
        """Drive through a junction, with so many quarter turns to the left, and on to where it is noticed."""
        passed = self.passed
        self._go(OPEN, 0.6, quarters * math.pi / 2)
        record = self.street()
        assert self.passed == passed + 1
        return record

    def way_to_the_first_junction(self) -> TickRecord:
        return self.street()

    def _go(self, counts: int, way_m: float, turn_rad: float) -> TickRecord:
        self.robot.counts = counts
        steps = round(way_m / STEP_M)
        off_m = turn_rad * ROBOT.geometry.effective_track_m / 2 / steps
        self.robot.left_m, self.robot.right_m = STEP_M - off_m, STEP_M + off_m
        for _ in range(steps):
            record = self.run()
        self.robot.left_m = self.robot.right_m = 0.0
        return record

    @property
    def ways(self) -> dict[int, str]:
        return {rla.rla_id: rla.action for rla in self.runtime.level.system.rlas_at(MID)}

    @property
    def history(self) -> tuple[str, ...]:
        assert self.runtime.mid is not None
        words = self.runtime.mid.settings.situation.describe(self.runtime.mid.vector)
        return tuple(word for word in words if word)


def told(record: TickRecord) -> Outcome:
    (result,) = record.results
    return result.outcome


def the_way(action: str, command_id: str = "way", of: int | None = None, *, next_to: bool = False) -> Teach:
    return Teach(command_id, "Ann", action, of, MID, next_to)


def another_way(action: str, command_id: str = "other", of: int | None = None) -> Correct:
    return Correct(command_id, "Ann", action, of, MID)


@pytest.fixture
def town() -> Town:
    """Stands before its first junction and has been told to go straight on there; RLA 4 says so."""
    town = Town()
    town.way_to_the_first_junction()
    town.run(the_way("straight_on", "first"))
    return town


def test_pursue_from_before_a_junction_is_refused(town: Town) -> None:
    seen = town.tick
    town.junction()
    record = town.run(Pursue("late", "Ann", "turn_left", seen))
    assert told(record) == Outcome(RefusalCode.JUNCTION_PASSED)
    assert record.behaviour == "straight_on"


def test_mid_lesson_about_the_past_keeps_the_override(town: Town) -> None:
    past = town.tick
    town.junction()
    town.run(Pursue("p", "Ann", "turn_left"))
    assert town.run(another_way("turn_right", of=past)).behaviour == "turn_left"


@pytest.mark.parametrize(
    ("command", "code"),
    [
        (the_way("forward"), RefusalCode.NO_BEHAVIOUR),
        (ReplaceAction("x", "Ann", 4, "forward"), RefusalCode.NO_BEHAVIOUR),
        (Teach("x", "Ann", "turn_left"), RefusalCode.NO_ACTION),
        (Teach("x", "Ann", "forward", None, "top"), RefusalCode.NO_LEVEL),
        (Correct("x", "Ann", "bad", None, CRITIC), RefusalCode.NO_LEVEL),
        (Teach("x", "Ann", "forward", alternative=True), RefusalCode.NO_OTHER_WAY),
        (Pursue("x", "Ann", "turn_back"), RefusalCode.NO_BEHAVIOUR),
    ],
)
def test_lesson_with_foreign_action_is_refused_unchanged(town: Town, command: Command, code: RefusalCode) -> None:
    before = town.runtime.level.system.knowledge_hash()
    assert told(town.run(command)).code is code
    assert town.runtime.level.system.knowledge_hash() == before
    assert town.run().behaviour == "straight_on"


def test_mid_lesson_without_mid_level_is_refused() -> None:
    record = Town(task=STREETS).run(the_way("turn_left"))
    assert told(record) == Outcome(RefusalCode.NO_MID_LEVEL)
    assert (record.mid, record.decision.asks_at) == (None, BASIC)


def test_a_blind_robot_still_knows_how_it_came_there(town: Town) -> None:
    town.robot.infrared_age_s = 60.0
    record = town.run(another_way("turn_left"), Correct("c", "Ann", "forward"))
    assert [result.accepted for result in record.results] == [True, False]
    assert record.decision.cause is DecisionCause.BLIND


def test_each_led_junction_counts_a_use_and_a_follow_up(town: Town) -> None:
    town.junction()
    town.junction()
    town.run(another_way("turn_left", "c-1"))  # RLA 5, in place of RLA 4 that had not come to anything there
    town.run(Stop("s", "Ann"))
    town.run(Resume("go", "Ann"))
    town.junction(1)
    saved = town.runtime.snapshot()
    assert (saved.uses[4], saved.uses[5]) == (2, 1)
    assert {edge: saved.transitions[edge] for edge in saved.transitions if min(edge) > 3} == {(4, 4): 1, (4, 5): 1}
    assert all((before < 4) == (after < 4) for before, after in saved.transitions)  # each level by itself


@pytest.mark.parametrize(
    ("of_an_older_task", "lesson", "fields"),
    [
        ((created(9, (0.0,) * LENGTH, "fly", level=MID), deleted(9)), "deletion-9", {"rla": 9, "level": MID}),
        (
            (created(9, (0.0,) * 72, "fly", behaviour="turn_left"), deleted(9)),
            "deletion-9",
            {"rla": 9, "behaviour": "turn_left"},
        ),
    ],
)
def test_undo_of_an_action_outside_the_task_is_refused(
    of_an_older_task: tuple[TeachingEvent, ...], lesson: str, fields: dict[str, Field]
) -> None:
    town = Town([*basic_knowledge(), *of_an_older_task])
    outcome = told(town.run(Undo("u", "Ann", lesson)))
    assert outcome == Outcome(RefusalCode.ACTION_NOT_IN_TASK, {**fields, "action": "fly"})
    assert not town.notebook.events
    town.run()
