"""What becomes of a teacher's commands."""

import math

import pytest

from kurt2rt.rla.rla import ActionReplaced, Origin, Phase, Rla, RlaCreated, RlaDeleted, TeachingEvent
from kurt2rt.rla.rla_system import RlaSystem
from kurt2rt.teaching.authority import Authority
from kurt2rt.teaching.commands import Command, CommandResult
from kurt2rt.teaching.school import School
from tests.layers.helpers import RADIUS, SmallLevel, situation
from tests.rla.helpers import created
from tests.teaching.helpers import correct, delete, replace_action, resume, set_phase, stop, teach

SHARE = 0.5
BORDER = SHARE * RADIUS


class Lesson:
    """A school over the actions a, b and c; each command comes one tick after the other."""

    def __init__(self, *events: TeachingEvent, taken: tuple[str, ...] = ()) -> None:
        self.small = SmallLevel(*events)
        self.school = School(
            self.small.level,
            Authority(self.small.actions, attended=False),
            insert_beyond_share=SHARE,
            taken_command_ids=taken,
        )
        self.events: list[TeachingEvent] = list(events)
        self.tick = 100

    def say(self, command: Command, place: float = 0.0) -> CommandResult:
        self.tick += 1
        result, event = self.school.attend(command, situation(place), self.tick)
        assert result.command_id == command.command_id
        if event is not None:
            self.events.append(event)
        return result

    @property
    def actions(self) -> dict[int, str]:
        return {rla.rla_id: rla.action for rla in self.small.level.system.rlas}


def test_teach_puts_an_rla_on_the_present_situation() -> None:
    lesson = Lesson()
    result = lesson.say(teach("a", "t-1"), place=2.5)
    assert result == CommandResult("t-1", True, "RLA 1 taught: a", lesson=True)
    assert lesson.events == [RlaCreated(Rla(1, (2.5,), "a", None, Origin("t-1", "Ann", Phase.SUPERVISED, 101)))]
    assert lesson.small.at(2.5).action == "a"


def test_teach_close_to_an_rla_inserts_another_one() -> None:
    lesson = Lesson(created(1, (0.0,), "a"))
    lesson.say(teach("b"), place=0.001)
    assert lesson.actions == {1: "a", 2: "b"}


def test_a_lesson_on_the_very_condition_of_an_rla_acts_as_well() -> None:
    """A second RLA there would be accepted and never win, because the older one does."""
    lesson = Lesson()
    lesson.say(teach("a", "first"), place=2.5)
    assert lesson.say(teach("a", "double click"), place=2.5).text == "RLA 1 says a already"
    result = lesson.say(teach("b", "another teacher"), place=2.5)
    assert (result.accepted, result.text) == (True, "RLA 1 corrected: b instead of a")
    assert lesson.actions == {1: "b"}
    assert lesson.small.at(2.5).action == "b"


def test_a_correction_up_to_the_border_replaces_the_action_of_the_nearest() -> None:
    lesson = Lesson(created(1, (0.0,), "a"))
    result = lesson.say(correct("b", "c-1"), place=BORDER)
    assert result.text == "RLA 1 corrected: b instead of a"
    assert lesson.events[-1] == ActionReplaced(1, "b", "a", Origin("c-1", "Ann", Phase.SUPERVISED, 101))
    assert lesson.actions == {1: "b"}


def test_a_correction_beyond_the_border_inserts_a_new_rla() -> None:
    lesson = Lesson(created(1, (0.0,), "a"))
    result = lesson.say(correct("b"), place=math.nextafter(BORDER, 100))
    assert result.text == "RLA 2 taught: b"
    assert lesson.actions == {1: "a", 2: "b"}


def test_the_border_is_a_share_of_the_nearest_rlas_own_radius() -> None:
    lesson = Lesson(created(1, (0.0,), "a", radius=2.0))
    lesson.say(correct("b"), place=1.5)
    assert lesson.actions == {1: "a", 2: "b"}


def test_a_correction_before_the_first_lesson_teaches() -> None:
    lesson = Lesson()
    assert lesson.say(correct("b")).text == "RLA 1 taught: b"


def test_a_correction_to_what_it_says_already_changes_nothing() -> None:
    lesson = Lesson(created(1, (0.0,), "a"))
    result = lesson.say(correct("a"), place=1.0)
    assert (result.accepted, result.text) == (True, "RLA 1 says a already")
    assert len(lesson.events) == 1


def test_one_rla_is_corrected_or_deleted_by_its_id_wherever_the_robot_is() -> None:
    lesson = Lesson(created(1, (0.0,), "a"), created(2, (50.0,), "b"))
    assert lesson.say(replace_action(2, "c", "r-1"), place=999.0).text == "RLA 2 corrected: c instead of b"
    assert lesson.say(delete(1, "d-1"), place=999.0).text == "RLA 1 deleted"
    assert lesson.events[2:] == [
        ActionReplaced(2, "c", "b", Origin("r-1", "Ann", Phase.SUPERVISED, 101)),
        RlaDeleted(1, Origin("d-1", "Ann", Phase.SUPERVISED, 102)),
    ]
    assert lesson.actions == {2: "c"}


def test_stop_and_resume() -> None:
    lesson = Lesson()
    assert lesson.say(stop()).text == "the robot stands until it is told to resume"
    assert lesson.school.stopped_because
    assert lesson.say(resume()).text == "the robot may drive"
    assert not lesson.school.stopped_because


def test_a_phase_goes_into_the_origin_of_what_is_taught_from_then_on() -> None:
    lesson = Lesson()
    lesson.say(teach("a", "t-1"), place=0.0)
    assert lesson.say(set_phase(Phase.CORRECTIONS)).text == "phase 2, corrections"
    lesson.say(teach("b", "t-2"), place=50.0)
    assert [event.origin.phase for event in lesson.events] == [Phase.SUPERVISED, Phase.CORRECTIONS]


@pytest.mark.parametrize("command", [teach("fly"), correct("fly"), replace_action(1, "fly")])
def test_an_action_that_is_not_in_the_repertoire_is_refused_with_those_that_are(command: Command) -> None:
    lesson = Lesson(created(1, (0.0,), "a"))
    result = lesson.say(command, place=100.0)
    assert (result.accepted, result.text) == (False, "there is no action 'fly'; the repertoire has: a, b, c")
    assert lesson.actions == {1: "a"}
    assert len(lesson.events) == 1
    assert lesson.school.corrections == 0


@pytest.mark.parametrize("command", [replace_action(1, "b"), delete(1), replace_action(9, "b"), delete(9), delete(0)])
def test_an_rla_that_does_not_live_is_refused(command: Command) -> None:
    lesson = Lesson(created(1, (0.0,), "a"), created(2, (50.0,), "b"))
    lesson.say(delete(1, "before"))
    result = lesson.say(command)
    assert not result.accepted
    assert "it may have been deleted" in result.text
    assert lesson.actions == {2: "b"}


@pytest.mark.parametrize(
    "command",
    [teach("b", "x"), correct("b", "x"), replace_action(1, "b", "x"), delete(1, "x"), set_phase(Phase.CRITIC, "x")],
)
def test_a_command_that_comes_twice_counts_once(command: Command) -> None:
    lesson = Lesson(created(1, (0.0,), "a"))
    assert lesson.say(command, place=100.0).accepted
    known, corrections = lesson.actions, lesson.school.corrections
    events = list(lesson.events)
    for place in (100.0, 200.0):
        assert lesson.say(command, place) == CommandResult("x", True, "had been taken already; counted once")
    assert (lesson.actions, lesson.events, lesson.school.corrections) == (known, events, corrections)


def test_a_stop_always_stops_and_a_late_copy_of_resume_does_not_act_again() -> None:
    lesson = Lesson()
    for command, stopped in ((stop("1"), True), (resume("2"), False), (stop("1"), True)):
        lesson.say(command)
        assert bool(lesson.school.stopped_because) == stopped
    lesson.say(resume("2"))
    assert lesson.school.stopped_because


def test_a_command_of_an_earlier_run_counts_once_as_well() -> None:
    lesson = Lesson(created(1, (0.0,), "a"), taken=("lesson-1",))
    assert lesson.school.has_taken("lesson-1")
    assert lesson.say(teach("b", "lesson-1"), place=100.0).text == "had been taken already; counted once"
    assert lesson.actions == {1: "a"}


def test_a_refused_command_may_come_again() -> None:
    lesson = Lesson()
    assert not lesson.say(delete(1, "x")).accepted
    lesson.say(teach("a"))
    assert lesson.say(delete(1, "x")).text == "RLA 1 deleted"


def test_the_events_of_a_lesson_fold_to_the_same_knowledge() -> None:
    lesson = Lesson()
    commands: list[tuple[Command, float]] = [
        (teach("a", "1"), 0.0),
        (teach("b", "2"), 20.0),
        (correct("c", "3"), 1.0),
        (correct("b", "4"), 7.0),
        (delete(2, "5"), 0.0),
        (teach("a", "6"), 20.0),
        (replace_action(3, "c", "7"), 0.0),
    ]
    for command, place in commands:
        assert lesson.say(command, place).accepted
    again = RlaSystem(1, RADIUS)
    again.apply_all(lesson.events)
    assert again.rlas == lesson.small.level.system.rlas
    assert again.knowledge_hash() == lesson.small.level.system.knowledge_hash()
    assert again.next_id == 5
