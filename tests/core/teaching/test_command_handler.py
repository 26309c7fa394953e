"""Outcomes of a teacher's commands."""

import math
from collections.abc import Callable

import pytest

from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.decision.standing import ActiveStop, StopReason
from kurt2rt.core.outcome import Outcome, RefusalCode, ResultCode
from kurt2rt.core.rla.events import ActionReplaced, LessonUndone, RlaCreated, SessionBegun, SessionEnded, TeachingEvent
from kurt2rt.core.rla.rla import BASIC, Origin, Phase, Rla
from kurt2rt.core.teaching.authority import ControlAuthority
from kurt2rt.core.teaching.command_handler import CommandHandler
from kurt2rt.core.teaching.commands import (
    BeginSession,
    Command,
    CommandResult,
    Correct,
    Drive,
    EndSession,
    HandOver,
    Pursue,
    Resume,
    Reward,
    RunBehaviour,
    SetPhase,
    Stop,
    Stream,
    Take,
    Teach,
    Undo,
)
from tests.core.helpers import RADIUS, SmallLevel, situation
from tests.core.reinforcement.helpers import Track
from tests.core.rla.helpers import created
from tests.teacher.helpers import correct, delete, pursue, replace_action, resume, set_phase, stop, teach

SHARE = 0.5
BORDER = SHARE * RADIUS


class Lesson:
    """A school over the actions a, b and c; each command comes one tick after the other."""

    def __init__(
        self, *events: TeachingEvent, taken: tuple[str, ...] = (), behaviours: tuple[str, ...] = ("",)
    ) -> None:
        self.small = SmallLevel(*events, behaviours=behaviours)
        self.school = CommandHandler(
            self.small.level,
            ControlAuthority(self.small.actions, attended=False),
            insert_radius_fraction=SHARE,
            handled_command_ids=taken,
        )
        self.events: list[TeachingEvent] = list(events)
        self.tick = 100

    def say(self, command: Command, place: float = 0.0) -> CommandResult:
        self.tick += 1
        assert not isinstance(command, Stream)
        result, events = self.school.handle(command, situation(place), self.tick)
        assert result.command_id == command.command_id
        self.events.extend(events)
        return result

    def go_on(self, place: float, ticks: int = 1, *, blind: bool = False) -> int:
        """So many ticks in one place, decided as the robot would; returns the last of them."""
        for _ in range(ticks):
            self.tick += 1
            decision = self.small.at(place, DecisionCause.BLIND if blind else None)
            behaviour = self.small.wanted.behaviour
            self.school.recent.add(self.tick, None if blind else situation(place), decision, behaviour)
        return self.tick

    def drive(self, teacher: str = "Ann", hold: int = 1) -> Outcome | None:
        """Have a press arrive in the next tick; return why it does not drive the robot."""
        self.tick += 1
        refusal = self.school.control.follow(Drive(teacher, self.tick, hold, 0.1, 0.1), self.tick)
        assert (refusal is None) == self.school.authority.is_manual(self.tick)
        return refusal

    @property
    def actions(self) -> dict[int, str]:
        return {rla.rla_id: rla.action for rla in self.small.level.system.rlas}


@pytest.fixture
def lesson() -> Lesson:
    return Lesson()


@pytest.fixture
def taught() -> Lesson:
    """Return a lesson in which the robot knows one RLA, with action a."""
    return Lesson(created(1, (0.0,), "a"))


def test_correction_up_to_the_border_replaces_the_action(taught: Lesson) -> None:
    result = taught.say(correct("b", "c-1"), place=BORDER)
    assert result.outcome == Outcome.of(ResultCode.RLA_CORRECTED, rla=1, action="b", was="a")
    assert taught.events[-1] == ActionReplaced(1, "b", "a", Origin("c-1", "Ann", Phase.SUPERVISED, 101))
    assert taught.actions == {1: "b"}


def test_a_correction_beyond_the_border_inserts_a_new_rla(taught: Lesson) -> None:
    result = taught.say(correct("b"), place=math.nextafter(BORDER, 100))
    assert result.outcome == Outcome.of(ResultCode.RLA_TAUGHT, rla=2, action="b")
    assert taught.actions == {1: "a", 2: "b"}


@pytest.mark.parametrize(
    "command", [teach("fly"), correct("fly"), replace_action(1, "fly"), RunBehaviour("1", "Ann", "fly", 9)]
)
def test_unknown_action_is_refused_with_the_known_ones(taught: Lesson, command: Command) -> None:
    result = taught.say(command, place=100.0)
    assert result.outcome == Outcome.of(RefusalCode.NO_ACTION, action="fly", known=("a", "b", "c"))
    assert taught.actions == {1: "a"}
    assert len(taught.events) == 1
    assert taught.school.corrections_at[BASIC] == 0


@pytest.mark.parametrize(
    "command",
    [teach("b", "x"), correct("b", "x"), replace_action(1, "b", "x"), delete(1, "x"), set_phase(Phase.CRITIC, "x")],
)
def test_a_command_that_comes_twice_counts_once(taught: Lesson, command: Command) -> None:
    assert taught.say(command, place=100.0).accepted
    known, corrections = taught.actions, taught.school.corrections_at[BASIC]
    events = list(taught.events)
    for place in (100.0, 200.0):
        assert taught.say(command, place) == CommandResult("x", Outcome(ResultCode.REPEATED))
    assert (taught.actions, taught.events, taught.school.corrections_at[BASIC]) == (known, events, corrections)


def test_a_command_of_an_earlier_run_counts_once_as_well() -> None:
    lesson = Lesson(created(1, (0.0,), "a"), taken=("lesson-1",))
    assert lesson.school.was_handled("lesson-1")
    assert lesson.say(teach("b", "lesson-1"), place=100.0).outcome == Outcome(ResultCode.REPEATED)
    assert lesson.actions == {1: "a"}


def test_a_correction_means_the_situation_of_the_tick_it_names() -> None:
    lesson = Lesson(created(1, (0.0,), "a"), created(2, (50.0,), "b"))
    wrong = lesson.go_on(0.0)
    lesson.go_on(50.0, 20)
    result = lesson.say(Correct("c-1", "Ann", "c", wrong), place=50.0)
    assert result.outcome == Outcome.of(ResultCode.RLA_CORRECTED, rla=1, action="c", was="a")
    assert lesson.actions == {1: "c", 2: "b"}
    assert lesson.events[-1].origin.tick == lesson.tick  # of the tick that took it


def test_stored_answer_does_not_change_later(lesson: Lesson) -> None:
    asked = lesson.go_on(2.5)
    lesson.say(Teach("t-1", "Ann", "a", asked), place=80.0)
    lesson.go_on(90.0, 1000)  # the place of that tick in memory is used again
    assert [rla.condition for rla in lesson.small.level.system.rlas] == [(2.5,)]


def test_lesson_about_a_blind_tick_is_refused(taught: Lesson) -> None:
    dark = taught.go_on(33.0, blind=True)
    taught.go_on(0.0)
    for command in (Teach("x", "Ann", "b", dark), Correct("x", "Ann", "b", dark)):
        result = taught.say(command)
        assert (result.outcome, taught.actions) == (Outcome(RefusalCode.WAS_BLIND), {1: "a"})


def test_reward_without_a_driving_rla_is_refused(taught: Lesson) -> None:
    assert not taught.say(Reward("r-0", "Ann", 1)).accepted  # before the first decision
    asked = taught.go_on(50.0)
    assert taught.say(Reward("r-1", "Ann", 1, asked)).outcome == Outcome(RefusalCode.NO_RLA_DROVE)
    drove = taught.go_on(0.0)
    taught.say(delete(1))
    assert taught.say(Reward("r-2", "Ann", -1, drove)).outcome == Outcome.of(RefusalCode.NO_RLA, rla=1)


def test_undo_without_name_undoes_newest_first(lesson: Lesson) -> None:
    lesson.say(teach("a", "1"), place=0.0)
    lesson.say(correct("b", "2"), place=0.0)
    assert lesson.say(Undo("u-1", "Ann")).lesson
    assert lesson.actions == {1: "a"}
    lesson.say(Undo("u-2", "Ann"))
    assert lesson.actions == {}
    undone = [event.lesson for event in lesson.events if isinstance(event, LessonUndone)]
    assert undone == ["2", "1"]
    result = lesson.say(Undo("u-3", "Ann"))
    assert result.outcome == Outcome(RefusalCode.NO_LESSON)


def test_impossible_undo_is_refused_unchanged(lesson: Lesson) -> None:
    lesson.say(teach("a", "1"), place=0.0)
    lesson.say(correct("b", "2"), place=0.0)
    refused = lesson.say(Undo("u-1", "Ann", "1"))
    assert (refused.accepted, refused.lesson) == (False, False)
    assert (refused.code, refused.outcome.fields["later"]) == (RefusalCode.TAUGHT_AFTER, "2")
    assert not lesson.say(Undo("u-2", "Ann", "never was")).accepted
    assert lesson.actions == {1: "b"}
    assert not lesson.school.was_handled("u-1")


def test_session_begins_and_ends_once_and_its_clock_runs(lesson: Lesson) -> None:
    school = lesson.school
    assert lesson.say(EndSession("e-0", "Ann")).outcome == Outcome(RefusalCode.NO_SESSION)
    assert school.clock.ticks(lesson.tick) == 0
    assert lesson.say(BeginSession("b-1", "Ann", "morning")).outcome == Outcome.of(
        ResultCode.SESSION_BEGUN, session="morning"
    )
    began = lesson.tick
    refused = lesson.say(BeginSession("b-2", "Ann", "noon"))
    assert refused.outcome == Outcome.of(RefusalCode.SESSION_ON, session="morning")
    assert (school.clock.session, school.clock.ticks(began + 70)) == ("morning", 70)

    lesson.tick = began + 99
    result = lesson.say(EndSession("e-1", "Ann"))
    assert (result.outcome, result.lesson) == (Outcome.of(ResultCode.SESSION_ENDED, session="morning"), True)
    assert school.stops.active == ActiveStop(StopReason.SESSION_OVER, "morning")
    assert school.clock.ticks(began + 5000) == 100
    assert lesson.say(EndSession("e-2", "Ann")).outcome == Outcome(RefusalCode.NO_SESSION)
    assert lesson.events == [
        SessionBegun("morning", Origin("b-1", "Ann", Phase.SUPERVISED, began)),
        SessionEnded(100, Origin("e-1", "Ann", Phase.SUPERVISED, began + 100)),
    ]
    lesson.say(BeginSession("b-3", "Ann", "noon"))
    assert school.clock.ticks(lesson.tick) == 0


def test_everybody_may_stop_and_nobody_becomes_the_teacher_by_it(lesson: Lesson) -> None:
    assert lesson.say(Stop("1", "Ben")).accepted
    assert lesson.school.authority.refusal_for("Dora") is None
    lesson.say(teach("a", "2"))
    lesson.say(Stop("3", "Cleo"))
    assert (lesson.school.stops.active, lesson.school.authority.teacher) == (
        ActiveStop(StopReason.SAID_STOP, "Cleo"),
        "Ann",
    )


def test_a_stop_ends_the_press_and_his_own_next_one_drives_again(lesson: Lesson) -> None:
    assert lesson.drive(hold=1) is None
    lesson.say(stop())
    assert lesson.drive(hold=1) == Outcome(RefusalCode.PRESS_OVER)
    assert lesson.drive(hold=2) is None


def test_after_another_ones_stop_a_new_press_waits_for_resume(lesson: Lesson) -> None:
    assert lesson.drive(hold=1) is None
    lesson.say(Stop("1", "Ben"))
    assert lesson.drive(hold=2) == Outcome.of(RefusalCode.STOPPED_BY, teachers=("Ben",))
    assert lesson.say(RunBehaviour("2", "Ann", "a", 10)).outcome == Outcome.of(
        RefusalCode.STOPPED_BY, teachers=("Ben",)
    )
    lesson.say(resume())
    assert lesson.drive(hold=2) is None


@pytest.mark.parametrize("own", [Stop("2", "Ann"), EndSession("2", "Ann")])
def test_an_own_stop_does_not_lift_that_of_another(lesson: Lesson, own: Command) -> None:
    """A copy of it may come late; the other one must not have stopped the robot for nothing."""
    lesson.say(BeginSession("0", "Ann", "morning"))
    lesson.say(Stop("1", "Ben"))
    assert lesson.say(own).accepted
    assert lesson.drive() == Outcome.of(RefusalCode.STOPPED_BY, teachers=("Ben",))
    lesson.say(resume())
    assert lesson.drive() is None


def test_take_over_clears_the_last_teachers_stop_only(lesson: Lesson) -> None:
    lesson.drive(hold=1)
    lesson.say(stop("1"))
    lesson.say(Take("2", "Ben"))
    assert lesson.school.stops.active
    assert lesson.drive("Ben", hold=1) is None
    lesson.say(Stop("3", "Cleo"))
    lesson.say(Take("4", "Ann"))
    assert lesson.drive(hold=9) == Outcome.of(RefusalCode.STOPPED_BY, teachers=("Cleo",))


def test_a_release_that_comes_late_ends_its_own_press_only(lesson: Lesson) -> None:
    lesson.drive(hold=1)
    release = Stop("1", "Ann", press_id=1)
    lesson.drive(hold=2)
    assert lesson.say(release).outcome == Outcome(ResultCode.RELEASE_SUPERSEDED)
    assert lesson.school.authority.is_manual(lesson.tick)
    assert lesson.say(Stop("2", "Ann", press_id=2)).accepted
    assert not lesson.school.authority.is_manual(lesson.tick)
    assert lesson.school.stops.active == ActiveStop(StopReason.LET_GO, "Ann")
    lesson.say(resume())
    assert lesson.say(Stop("2", "Ann", press_id=2)).outcome == Outcome(ResultCode.REPEATED)
    assert not lesson.school.stops.active


@pytest.mark.parametrize(
    "late",
    [
        lambda tick: Resume("2", "Ann", tick),
        lambda tick: RunBehaviour("2", "Ann", "a", 10, tick),
        lambda tick: SetPhase("2", "Ann", Phase.AUTONOMOUS, tick),
        lambda tick: Pursue("2", "Ann", "", tick),
    ],
)
def test_command_from_before_a_stop_does_not_move_the_robot(lesson: Lesson, late: Callable[[int], Command]) -> None:
    lesson.say(stop("1"))
    refused = lesson.say(late(lesson.tick - 1))
    assert refused.outcome == Outcome(RefusalCode.STOPPED_SINCE)
    assert lesson.school.stops.active
    assert lesson.say(late(lesson.tick)).accepted


# Several taught behaviours.

TURNS = ("straight_on", "turn_left", "turn_right")


@pytest.mark.parametrize(("behaviours", "known"), [(TURNS, TURNS), (("",), ("",))])
def test_unknown_behaviour_is_refused_with_the_known_ones(behaviours: tuple[str, ...], known: tuple[str, ...]) -> None:
    lesson = Lesson(behaviours=behaviours)
    result = lesson.say(pursue("fly"))
    assert result.outcome == Outcome.of(RefusalCode.NO_BEHAVIOUR, behaviour="fly", known=known)
    assert lesson.small.wanted.behaviour == behaviours[0]
    assert lesson.school.authority.teacher is None


def test_pursue_needs_authority_and_keeps_a_stop() -> None:
    lesson = Lesson(behaviours=TURNS)
    lesson.say(Take("take", "Bob"))
    lesson.say(Stop("stop", "Bob"))
    assert not lesson.say(pursue("turn_left")).accepted
    assert lesson.small.wanted.behaviour == "straight_on"
    lesson.say(Take("take it", "Ann"))
    assert lesson.say(pursue("turn_left")).accepted
    assert lesson.school.stops.active == ActiveStop(StopReason.SAID_STOP, "Bob")


@pytest.mark.parametrize(
    "command",
    [
        *(Teach("x", "critic", "a"), Correct("x", "critic", "a"), Reward("x", "critic", 1), Undo("x", "critic")),
        *(SetPhase("x", "critic", Phase.AUTONOMOUS), Resume("x", "critic"), Take("x", "critic")),
        HandOver("x", "Ann", "critic"),
    ],
)
def test_nobody_teaches_in_the_critics_name(taught: Lesson, command: Command) -> None:
    taught.go_on(0.0)
    result = taught.say(command)
    assert not result.accepted
    assert result.outcome == Outcome.of(RefusalCode.CRITICS_NAME, name="critic")
    assert taught.school.authority.teacher != "critic"


def test_critics_name_may_stop_and_nothing_else(lesson: Lesson) -> None:
    assert lesson.drive("critic") == Outcome.of(RefusalCode.CRITICS_NAME, name="critic")
    assert lesson.say(Stop("s", "critic")).accepted


def test_own_change_that_does_not_fit_is_skipped_and_reported() -> None:
    taken = Origin("signal-3/withdraw-1", "Ann", Phase.SUPERVISED, 1)  # an earlier kurt2rt took such ids
    first = RlaCreated(Rla(1, (0.0,), "a", None, taken))
    robot = Track(first, created(2, (50.0,), "b"), phase=Phase.REINFORCEMENT)
    for _ in range(3):
        robot.go(0.0, 200)
        robot.signal(-1)
    assert robot.school.updater.error == ""
    assert robot.go(0.0).driving
    assert robot.learnt == []
    assert "'signal-3/withdraw-1'" in robot.school.updater.error
    assert robot.go(0.0).action == "a"


@pytest.mark.parametrize(
    ("seen", "unseen", "lifted"),
    [
        ([stop("1")], [stop("1")], True),
        ([stop("1"), resume("2")], [stop("1")], False),  # it ended a drive
        ([stop("1")], [Stop("2", "Ben"), stop("1")], False),
        ([stop("1"), Stop("2", "Ben")], [stop("1")], True),
    ],
)
def test_copy_of_a_stop_brakes_and_is_newer_after_a_resume_only(
    lesson: Lesson, seen: list[Command], unseen: list[Command], lifted: bool
) -> None:
    for command in seen:
        lesson.say(command)
    seen_tick = lesson.tick
    for command in unseen:
        lesson.say(command)
    assert lesson.school.stops.active
    assert lesson.say(Resume("3", "Ann", seen_tick)).accepted is lifted
    assert bool(lesson.school.stops.active) is not lifted
