"""The tick as a story, continued: teachers who are there or not, a hand on the wheels, and decisions of the past."""

import itertools
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hal.guard_reason import GuardReason
from hal.robot import STANDSTILL, WheelSpeeds
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.outcome import ResultCode
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.teaching.commands import (
    BeginSession,
    Command,
    Correct,
    DeleteRla,
    Drive,
    EndSession,
    HandOver,
    HoldAction,
    Resume,
    Reward,
    RunBehaviour,
    SetPhase,
    Stop,
    Stream,
    Take,
    Teach,
    Undo,
    Watch,
)
from kurt2rt.core.tick_record import TickRecord
from tests.core.helpers import runs_away
from tests.core.test_tick import FORWARD, Corridor
from tests.examples import examples
from tests.teacher.helpers import resume, set_phase, stop, teach

LEASE, REACH = 24, 35
BY_HAND = WheelSpeeds(0.21, 0.19)


def press(corridor: Corridor, hold: int = 1, *, teacher: str = "Ann", age: int = 0) -> Drive:
    """One message of a press that arrives in the next tick, on the picture of `age` ticks before that."""
    return Drive(teacher, corridor.ticks + 1 - age, hold, *BY_HAND)


def watch(corridor: Corridor, teacher: str = "Ann", *, age: int = 0) -> Watch:
    return Watch(teacher, corridor.ticks + 1 - age)


def causes(corridor: Corridor, ticks: int, counts: int | None = None) -> list[DecisionCause]:
    return [corridor.run(counts).decision.cause for _ in range(ticks)]


def stands(record: TickRecord) -> bool:
    return record.guard_result.wheel_speeds == STANDSTILL


@pytest.fixture
def attended() -> Corridor:
    """Return a robot that needs a teacher, was taught to drive forward at 100, and whose teacher is absent."""
    corridor = Corridor(attended=True)
    corridor.run(100, teach("forward", "first"))
    return corridor


def test_press_drives_for_its_lease_then_robot_stands(driving: Corridor) -> None:
    first = driving.run(100, press(driving))
    assert (first.decision.cause, first.decision.action, first.decision.rla_id) == (
        DecisionCause.TEACHER,
        "by hand",
        None,
    )
    assert first.guard_result.wheel_speeds == BY_HAND
    assert first.decision.match is not None  # what the robot would have done stays to be seen
    assert causes(driving, LEASE - 1) == [DecisionCause.TEACHER] * (LEASE - 1)
    assert causes(driving, 200) == [DecisionCause.STOPPED] * 200
    assert driving.run(100, resume()).guard_result.wheel_speeds == FORWARD


def test_late_older_press_neither_drives_nor_revives_the_newer(driving: Corridor) -> None:
    driving.run(100, press(driving, hold=1))
    driving.run(100, press(driving, hold=4))
    assert not stands(driving.run(100, press(driving, hold=1)))  # the newer one still drives
    for _ in range(LEASE):
        record = driving.run(100)
    assert stands(record)
    assert stands(driving.run(100, press(driving, hold=1)))
    assert stands(driving.run(100, press(driving, hold=4)))
    assert not stands(driving.run(100, press(driving, hold=5)))


@pytest.mark.parametrize("by", ["Ann", "Ben"])
def test_a_stop_of_anyone_ends_the_press_in_the_same_tick(driving: Corridor, by: str) -> None:
    driving.run(100, press(driving))
    record = driving.run(100, press(driving), Stop("s", by), press(driving))
    assert (record.decision.cause, record.guard_result.wheel_speeds) == (DecisionCause.STOPPED, STANDSTILL)
    assert stands(driving.run(100, press(driving)))
    assert (driving.run(100, press(driving, hold=2)).decision.cause is DecisionCause.TEACHER) == (by == "Ann")
    driving.run(100, resume())
    assert driving.run(100, press(driving, hold=3)).decision.cause is DecisionCause.TEACHER


def test_manual_drive_with_faulty_level_credits_no_rla(driving: Corridor, monkeypatch: pytest.MonkeyPatch) -> None:
    uses = dict(driving.statistics.uses)
    runs_away(monkeypatch, wheel_speeds=FORWARD, cause=DecisionCause.RLA, action="back", rla_id=1, answers=True)
    for _ in range(5):
        record = driving.run(100, press(driving))
        assert (record.decision.cause, record.decision.rla_id) == (DecisionCause.TEACHER, None)
        assert not record.decision.answers
        assert record.guard_result.wheel_speeds == BY_HAND
    assert driving.statistics.uses == uses


def test_attended_robot_without_teacher_stands_or_asks(attended: Corridor) -> None:
    assert causes(attended, 5, 100) == [DecisionCause.UNATTENDED] * 5
    assert causes(attended, 5, 400) == [DecisionCause.UNKNOWN] * 5
    assert causes(attended, 5, 100) == [DecisionCause.UNATTENDED] * 5
    assert set(attended.robot.driven) == {STANDSTILL}


def test_attended_robot_that_lost_its_teacher_needs_resume(attended: Corridor) -> None:
    attended.run(100, watch(attended))
    assert causes(attended, LEASE - 1) == [DecisionCause.RLA] * (LEASE - 1)
    assert attended.run(100).decision.cause is DecisionCause.STOPPED
    assert causes(attended, 50) == [DecisionCause.STOPPED] * 50
    assert attended.run(100, watch(attended)).decision.cause is DecisionCause.STOPPED
    assert attended.run(100, watch(attended), resume()).decision.cause is DecisionCause.RLA


def test_a_robot_taken_while_it_drives_waits_for_its_new_teacher(attended: Corridor) -> None:
    attended.run(100, watch(attended))
    record = attended.run(100, watch(attended), Take("take", "Ben"))
    assert record.results[0].accepted
    assert stands(record)
    assert attended.run(100, watch(attended, "Ben"), Resume("r", "Ben")).decision.cause is DecisionCause.RLA


def test_phase_5_needs_no_teacher_and_its_end_stops_the_robot(attended: Corridor) -> None:
    attended.run(100, set_phase(Phase.AUTONOMOUS))
    assert causes(attended, 200) == [DecisionCause.RLA] * 200
    assert attended.run(100, set_phase(Phase.CORRECTIONS, "back to 2")).decision.cause is DecisionCause.STOPPED


def test_a_refused_resume_does_not_release_an_emergency_stop(driving: Corridor) -> None:
    driving.robot.emergency_stop(GuardReason.PROGRAM_WAITS)
    record = driving.run(100, Resume("r", "Ben"))
    assert not record.results[0].accepted
    assert record.guard_result.latched


def test_lease_expires_while_latched_and_ends_the_press(driving: Corridor) -> None:
    driving.run(100, press(driving))
    driving.robot.emergency_stop(GuardReason.PROGRAM_WAITS)
    causes(driving, LEASE)
    driving.robot.release()
    assert stands(driving.run(100, press(driving)))


def test_stop_and_resume_of_one_tick_count_in_their_order(driving: Corridor) -> None:
    assert driving.run(100, resume("1"), stop("2")).decision.cause is DecisionCause.STOPPED
    assert driving.run(100, stop("3"), resume("4")).decision.cause is DecisionCause.RLA


NAMES = st.sampled_from(["Ann", "Ann", "Ben", "Cleo"])

Kind = Callable[[str, str, int, int], Command]
"""Makes a command of: command id, teacher, tick that is meant, a small number."""


def drive(_: str, who: str, tick: int, number: int) -> Drive:
    """Return a drive command whose speed identifies its press."""
    return Drive(who, tick, number, 0.1 + number / 100, 0.1)


def hold(_: str, who: str, tick: int, number: int) -> HoldAction:
    """Hold an action."""
    return HoldAction(who, tick, number, "back" if number % 2 else "forward")


KINDS: list[Kind] = [
    *[drive] * 5,
    *[hold] * 3,
    *[lambda name, who, _, __: Stop(name, who)] * 3,
    *[lambda name, who, _, __: Resume(name, who)] * 2,
    *[lambda _, who, tick, __: Watch(who, tick)] * 2,
    lambda name, who, _, __: Take(name, who),
    lambda name, who, _, number: HandOver(name, who, [None, "Ann", "Ben", "Cleo", "absent"][number]),
    lambda name, who, _, number: RunBehaviour(name, who, "back", 10 * number + 1),
    lambda name, who, _, number: SetPhase(name, who, Phase(number + 1)),
    lambda name, who, tick, number: Teach(name, who, "forward", tick if number else None),
    lambda name, who, tick, number: Correct(name, who, "back", tick if number else None),
    lambda name, who, tick, number: Reward(name, who, 1, tick if number else None),
    lambda name, who, _, number: DeleteRla(name, who, number),
    lambda name, who, _, __: Undo(name, who),
    lambda name, who, _, __: BeginSession(name, who, "morning"),
    lambda name, who, _, __: EndSession(name, who),
]

COURSES = st.lists(
    st.tuples(
        st.sampled_from([0, 1, 5, LEASE - 1, LEASE]),
        st.lists(
            st.tuples(
                st.sampled_from(KINDS), NAMES, st.sampled_from([0, 0, 4, 20, REACH]), st.integers(0, 4), st.booleans()
            ),
            min_size=1,
            max_size=3,
        ),
        st.sampled_from([100, 100, 100, 400]),
    ),
    max_size=20,
)
"""Arrivals after a number of ticks, and the counts of the sensors until then.

A command is (kind, teacher, age of the picture, number, whether an older command arrives again in its place)."""


class Witness:
    """Knows the rules and nothing of the code."""

    def __init__(self) -> None:
        self.messages: list[tuple[str, int, int]] = []
        """Of presses: teacher, tick of arrival, tick of the picture."""
        self.stops: set[str] = set()
        """Teachers who stopped the robot since the last resume; a teacher who takes it over may drive by hand."""
        self.teachers: set[str] = set()
        """Who may have been the teacher by now, within this tick."""
        self.lost = False
        """Whether the robot drove and lost its teacher since the last resume."""
        self.drove: set[tuple[str, float]] = set()
        """Presses that moved the robot: teacher, and the speed that tells which it was."""
        self.hand: str | None = None
        """Whose hand drove in the tick before."""
        self.drove_by_itself = False

    def note(self, command: Command, tick: int, *, carried_out: bool) -> None:
        """Record a command that arrived in this tick."""
        match command:
            case Drive(teacher=who, seen_tick=seen) | HoldAction(teacher=who, seen_tick=seen):
                self.messages.append((who, tick, seen))
            case Stop(teacher=who):
                self.stops.add(who)
            case Resume() if carried_out:
                self.stops.clear()
                self.lost = False
            case Take() if carried_out:
                self.stops -= self.teachers
            case HandOver(teacher=who, to=to) if carried_out:
                self.stops.discard(who)
                self.teachers.update(() if to is None else (to,))
        if carried_out or isinstance(command, Drive | HoldAction):
            self.teachers.add(command.teacher)

    def hears(self, driver: str | None, tick: int) -> bool:
        """Return whether a message of a press still lets its teacher drive."""
        return any(
            who == driver and tick - arrived < LEASE and tick - seen < REACH for who, arrived, seen in self.messages
        )

    def check(self, record: TickRecord, corridor: Corridor) -> None:
        """Assert the rules after a tick."""
        school, decision = corridor.school, record.decision
        teacher, moves = school.authority.teacher, not stands(record)
        alone = school.requires_teacher and not school.authority.is_present(record.tick)
        if self.drove_by_itself and alone:
            self.lost = True
        hand = teacher if decision.action == "by hand" else None
        if hand is not None:
            assert self.hears(hand, record.tick)
            press = (hand, decision.wheel_speeds.left_m_s)
            assert press not in self.drove or self.hand == hand
            self.drove.add(press)
        if moves and decision.cause is DecisionCause.TEACHER and school.authority.held_press is not None:
            assert school.stops.active is None
            assert not self.stops
            assert self.hears(teacher, record.tick)
        if moves:
            assert not alone
            assert self.stops <= {teacher}
        self.drove_by_itself = moves and decision.cause is not DecisionCause.TEACHER
        if self.drove_by_itself:
            assert not self.stops
            assert not self.lost
        self.hand = hand
        self.teachers = set() if teacher is None else {teacher}


@given(courses=COURSES, attended=st.booleans())
@examples(300)
def test_three_random_teachers_keep_rules_of_manual_drive(
    courses: list[tuple[int, list[tuple[Kind, str, int, int, bool]], int]], attended: bool
) -> None:
    corridor = Corridor(attended=attended)
    corridor.run(100, Teach("before", "Ann", "forward"), HandOver("free", "Ann"))
    witness = Witness()
    names = itertools.count()
    said: list[Command] = []
    for wait, messages, counts in courses:
        for _ in range(wait):
            witness.check(corridor.run(counts), corridor)
        commands: list[Command] = []
        for kind, who, age, number, old in messages:
            command = kind(f"{next(names)}", who, max(0, corridor.ticks + 1 - age), number)
            commands.append(said[len(said) // 2] if old and said else command)
        said += commands
        record = corridor.run(counts, *commands)
        results = iter(record.results)
        for command in commands:
            result = None if isinstance(command, Stream) else next(results)
            carried_out = result is not None and result.accepted and result.code is not ResultCode.REPEATED
            witness.note(command, record.tick, carried_out=carried_out)
        witness.check(record, corridor)


@pytest.mark.parametrize(("trouble", "cause"), [("disk full", DecisionCause.UNSAVED), (None, DecisionCause.BLIND)])
def test_manual_drive_is_blocked_if_blind_or_unsaved(
    driving: Corridor, trouble: str | None, cause: DecisionCause
) -> None:
    assert not stands(driving.run(100, press(driving)))
    driving.notebook.saving_error = trouble
    driving.robot.infrared_age_s = 0.0 if trouble else 1.0
    record = driving.run(100, press(driving))
    assert (record.decision.cause, record.decision.action, record.decision.wheel_speeds) == (cause, None, STANDSTILL)
