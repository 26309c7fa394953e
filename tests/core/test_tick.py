"""The tick as a story: a robot in a corridor that knows nothing, and a teacher who tells it what to do."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from behaviors.behaviour import Behaviour
from behaviors.motor_primitive import MotorPrimitive
from hal.guard_reason import GuardReason
from hal.robot import STANDSTILL, GuardResult, SensorReadings, WheelSpeeds
from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.decision.decision import ActiveBehaviour, DecisionCause
from kurt2rt.core.event_store import InMemoryEventStore
from kurt2rt.core.outcome import Outcome, RefusalCode, ResultCode
from kurt2rt.core.perception.perception import Perception
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import StatisticsCounter
from kurt2rt.core.teaching.authority import ControlAuthority
from kurt2rt.core.teaching.command_handler import CommandHandler
from kurt2rt.core.teaching.commands import Command, Resume
from kurt2rt.core.teaching.inbox import TeacherInbox
from kurt2rt.core.teaching.knowledge_updater import HandlerParts
from kurt2rt.core.tick import Tick
from kurt2rt.core.tick_parts import TickOptions, TickParts
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.platform.tick_timer import TickTimer
from tests.core.helpers import runs_away
from tests.core.perception.helpers import READINGS, SENSORS, WHEELS, definition
from tests.teacher.helpers import correct, delete, resume, stop, teach

FORWARD, BACK = WheelSpeeds(0.3, 0.3), WheelSpeeds(-0.15, -0.15)
RADIUS = 50.0
PAST_WEIGHT = 0.1  # little, so that the first seconds of a history are not another situation


class CorridorRobot:
    """Robot whose four sensors show one count that the test sets.

    Its guard passes each command until it latches, but stops a drive toward a pressed bumper.
    """

    def __init__(self) -> None:
        self.counts = 100
        self.infrared_age_s = 0.0
        self.command_ages_s: list[float] = []
        self.latched = self.relatches = False
        self.driven: list[WheelSpeeds] = []
        self.closed = False
        self.touches_in_front = False
        self.latches_for = GuardReason.PROGRAM_WAITS

    def sense(self, now_s: float) -> SensorReadings:
        return SensorReadings(now_s, (self.counts,) * 4, self.infrared_age_s, 0, 0, 0.0, 0, 0.0)

    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:
        self.command_ages_s.append(now_s - decided_at_s)
        self.latched = self.latched or self.relatches
        applied, reasons = (STANDSTILL, (self.latches_for,)) if self.latched else (wanted, ())
        if self.touches_in_front and max(applied) > 0.0:
            applied, reasons = WheelSpeeds(min(applied[0], 0.0), min(applied[1], 0.0)), (GuardReason.FRONT_BUMPER,)
        self.driven.append(applied)
        return GuardResult(applied, reasons, self.latched)

    def emergency_stop(self, reason: GuardReason) -> None:
        assert reason
        self.latched = True

    def release(self) -> None:
        self.latched = False

    def close(self) -> None:
        self.closed = True


class Corridor:
    """All that stands round a Tick, and one tick in a call."""

    def __init__(
        self,
        *,
        attended: bool = False,
        behaviours: tuple[str, ...] = ("",),
        tolerates_stalls: bool = False,
        asked: bool = True,
        asks_when_held: bool = True,
        ask_radius_fraction: float = 1.0,
        answers_override_holds: bool = False,
    ) -> None:
        self.robot = CorridorRobot()
        self.notebook = InMemoryEventStore()
        self.held_up_s = 0.0
        """How long a tick hangs between its readings and its frame."""
        repertoire: dict[str, Behaviour] = {"forward": MotorPrimitive(FORWARD), "back": MotorPrimitive(BACK)}
        small = definition((*READINGS, *WHEELS), scale=10)
        self.system = RlaSystem(small.dimensions, RADIUS, np.repeat((1.0, PAST_WEIGHT), small.dimensions // 2))
        self.level = BasicLevel(
            self.system, repertoire, minimum_action_ticks=3, active_behaviour=ActiveBehaviour(behaviours)
        )
        self.inbox = TeacherInbox()
        self.statistics = StatisticsCounter()
        self.timer = TickTimer()
        authority = ControlAuthority(repertoire, attended=attended)
        self.school = CommandHandler(
            self.level,
            authority,
            insert_radius_fraction=0.5,
            handled_command_ids=(),
            teacher_available=asked,
            ask_radius_fraction=ask_radius_fraction,
            parts=HandlerParts(answers_override_holds=answers_override_holds),
        )
        parts = TickParts(
            robot=self.robot,
            perception=Perception(small, SENSORS),
            level=self.level,
            handler=self.school,
            inbox=self.inbox,
            event_store=self.notebook,
            statistics=self.statistics,
            timer=self.timer,
        )
        options = TickOptions(stale_infrared_s=0.05, tolerates_stalls=tolerates_stalls, asks_at_bumper=asks_when_held)
        self.tick = Tick(parts, options, now=lambda: self.ticks * 0.01 + self.held_up_s)
        self.ticks = 0

    def run(self, counts: int | None = None, *commands: Command) -> TickRecord:
        """One tick, in which the sensors show `counts` and these commands have just arrived."""
        if counts is not None:
            self.robot.counts = counts
        for command in commands:
            self.inbox.put(command)
        self.ticks += 1
        self.timer.begin(0.0)
        record = self.tick.run(self.ticks, self.ticks * 0.01)
        self.timer.end()
        return record


def averages(record: TickRecord) -> list[float]:
    values: list[float] = (record.situation.vector[4:]).tolist()
    return values


@pytest.fixture
def corridor() -> Corridor:
    return Corridor()


def test_untaught_it_asks_and_stands_with_its_history_frozen(corridor: Corridor) -> None:
    records = [corridor.run(counts) for counts in (100, 150, 200)]
    for record in records:
        assert record.decision.asking
        assert record.decision.cause is DecisionCause.UNKNOWN
        assert record.guard_result.wheel_speeds == STANDSTILL
        assert record.situation.history_frozen
        assert averages(record) == averages(records[0])
    assert [record.situation.vector[0] for record in records] == [100, 150, 200]
    assert corridor.robot.driven == [STANDSTILL] * 3


def test_a_lesson_acts_in_the_very_tick_that_takes_it(corridor: Corridor) -> None:
    corridor.run()
    record = corridor.run(100, teach("forward", "t-1"))
    assert [(result.command_id, result.accepted) for result in record.results] == [("t-1", True)]
    assert (record.decision.cause, record.decision.action, record.decision.rla_id) == (DecisionCause.RLA, "forward", 1)
    assert corridor.robot.driven == [STANDSTILL, FORWARD]
    assert corridor.system.rlas[0].condition == tuple(record.situation.vector.tolist())
    assert [event.origin.command_id for event in corridor.notebook.events] == ["t-1"]
    assert corridor.notebook.events[0].origin.tick == record.tick == 2
    assert corridor.run().results == ()


def test_an_unknown_situation_stops_the_wheels_in_the_same_tick(driving: Corridor) -> None:
    driving.run(400)
    assert driving.robot.driven[-2:] == [FORWARD, STANDSTILL]


def test_stop_holds_until_resume_and_history_waits(driving: Corridor) -> None:
    stopped = driving.run(100, stop())
    assert (stopped.decision.cause, stopped.guard_result.wheel_speeds) == (DecisionCause.STOPPED, STANDSTILL)
    for _ in range(5):
        record = driving.run()
        assert record.decision.cause is DecisionCause.STOPPED
        assert record.situation.history_frozen
        assert not record.decision.asking
    assert driving.run(100, resume()).guard_result.wheel_speeds == FORWARD


def test_while_lessons_cannot_be_saved_it_stands_and_says_why(driving: Corridor) -> None:
    driving.notebook.saving_error = "disk full"
    record = driving.run()
    assert (record.decision.cause, record.guard_result.wheel_speeds) == (DecisionCause.UNSAVED, STANDSTILL)
    assert driving.run().situation.history_frozen
    driving.run(100, correct("back", "while unsaved"))
    assert driving.notebook.events[-1].origin.command_id == "while unsaved"  # not lost: it waits there
    driving.notebook.saving_error = None
    assert driving.run().decision.action == "back"


def test_a_teachers_stop_goes_before_trouble_with_saving(driving: Corridor) -> None:
    driving.notebook.saving_error = "disk full"
    assert driving.run(100, stop()).decision.cause is DecisionCause.STOPPED


def test_tick_emergency_stop_freezes_history_until_resume(driving: Corridor) -> None:
    driving.robot.emergency_stop(GuardReason.PROGRAM_WAITS)
    first = driving.run()
    assert first.guard_result == GuardResult(STANDSTILL, (GuardReason.PROGRAM_WAITS,), latched=True)
    for _ in range(5):
        record = driving.run()
        assert record.guard_result.latched
        assert record.situation.history_frozen
    assert driving.run(100, resume()).guard_result.wheel_speeds == FORWARD
    assert not driving.run().situation.history_frozen


def test_tick_late_copy_of_resume_keeps_new_emergency_stop(driving: Corridor) -> None:
    driving.run(100, stop("s"))
    driving.run(100, resume("again"))
    driving.robot.emergency_stop(GuardReason.PROGRAM_WAITS)
    record = driving.run(100, resume("again"))
    assert record.results[0].outcome == Outcome(ResultCode.REPEATED)
    assert record.guard_result.latched
    assert not driving.run(100, resume("after a look")).guard_result.latched


def test_tick_resume_from_before_emergency_stop_is_refused(driving: Corridor) -> None:
    said_on = driving.run(100).tick
    driving.robot.emergency_stop(GuardReason.PROGRAM_WAITS)
    stopped_on = driving.run(100).tick
    late = driving.run(100, Resume("on its way", "Ann", said_on))
    assert late.results[0].outcome == Outcome(RefusalCode.STOPPED_SINCE)
    assert late.guard_result.latched
    assert not driving.run(100, Resume("after a look", "Ann", stopped_on)).guard_result.latched


def test_tick_resume_keeps_emergency_stop_of_its_own_tick(driving: Corridor) -> None:
    driving.robot.emergency_stop(GuardReason.PROGRAM_WAITS)  # as the readings of the next tick do
    assert driving.run(100, resume("said before")).guard_result.latched
    assert not driving.run(100, resume("after a look")).guard_result.latched


def test_tick_stop_in_the_tick_of_a_resume_needs_another(driving: Corridor) -> None:
    driving.robot.emergency_stop(GuardReason.BUS_LOST)
    seen = driving.run(100).tick
    driving.robot.relatches = True
    again = driving.run(100, Resume("1", "Ann", seen))
    assert again.guard_result.latched
    driving.robot.relatches = False
    assert driving.run(100, Resume("2", "Ann", seen)).guard_result.latched
    assert not driving.run(100, Resume("3", "Ann", again.tick)).guard_result.latched


def journey(seed: int) -> tuple[list[TickRecord], str, Sequence[TeachingEvent]]:
    """400 ticks through changing counts with lessons, corrections, stops and deletions thrown in by chance."""
    chance = np.random.default_rng(seed)
    corridor = Corridor()
    records = []
    for number in range(400):
        commands: list[Command] = []
        if number % 7 == 0:
            name, action = f"{seed}-{number}", ("forward", "back")[int(chance.integers(2))]
            rla_id = int(chance.integers(1, 20))
            choices: list[Command] = [
                *(teach(action, name), correct(action, name), delete(rla_id, name)),
                *(stop(name), resume(name), resume(name)),
            ]
            commands = [choices[int(chance.integers(len(choices)))]]
        walk = int(np.clip(corridor.robot.counts + chance.integers(-15, 16), 60, 560))
        records.append(corridor.run(walk, *commands))
    return records, corridor.system.knowledge_hash(), corridor.notebook.events


def printed(records: Sequence[TickRecord]) -> list[str]:
    """Return the records as text with all digits, because situations are arrays and do not compare as a whole."""
    return [repr((record, record.situation.vector.tolist())) for record in records]


def test_tick_equal_inputs_give_equal_records_and_knowledge() -> None:
    first, second, other = journey(1), journey(1), journey(2)
    assert printed(first[0]) == printed(second[0])
    assert first[1:] == second[1:]
    assert first[1] != other[1]
    causes = {record.decision.cause for record in first[0]}
    assert causes == {
        DecisionCause.RLA,
        DecisionCause.HELD,
        DecisionCause.UNKNOWN,
        DecisionCause.STOPPED,
    }  # the journey has seen it all


def test_tick_delayed_tick_gives_guard_the_decisions_age(driving: Corridor) -> None:
    driving.run(100)
    driving.held_up_s = 0.09
    driving.run(100)
    assert driving.robot.command_ages_s[-2:] == pytest.approx([0.0, 0.09])


def test_tick_blind_robot_stands_without_asking_or_learning(driving: Corridor) -> None:
    known = len(driving.system)
    driving.robot.infrared_age_s = math.inf
    record = driving.run(100, teach("back", "in the dark"))
    assert record.decision.cause is DecisionCause.BLIND
    assert record.guard_result.wheel_speeds == STANDSTILL
    (result,) = record.results
    assert not result.accepted
    assert result.outcome == Outcome(RefusalCode.BLIND)
    assert len(driving.system) == known

    driving.robot.infrared_age_s = 0.0
    assert driving.run(100).decision.cause is DecisionCause.RLA
    assert driving.run(100, teach("back", "in the dark")).results[0].accepted


@pytest.mark.parametrize("says_why", [False, True])
def test_tick_faulty_level_does_not_drive_a_stopped_robot(
    driving: Corridor, monkeypatch: pytest.MonkeyPatch, says_why: bool
) -> None:
    driving.run(None, stop("enough"))
    wrong = {"cause": DecisionCause.RLA, "action": "ahead", "rla_id": 1} if says_why else {}
    runs_away(monkeypatch, wheel_speeds=FORWARD, **wrong)
    for _ in range(5):
        record = driving.run()
        assert record.decision.cause is DecisionCause.STOPPED
        assert not record.decision.driving
        assert record.decision.wheel_speeds == record.guard_result.wheel_speeds == STANDSTILL
    driving.run(None, resume("go on"))
    assert driving.run().guard_result.wheel_speeds == FORWARD
