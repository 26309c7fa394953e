"""Lessons of a held action: "hold to correct"."""

from dataclasses import dataclass
from typing import NamedTuple

from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.lesson_history import DERIVED, hold_id
from kurt2rt.core.rla.phase import Phase
from kurt2rt.core.rla.rla import Origin
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.teaching.commands import HoldAction
from kurt2rt.core.teaching.lesson_builder import LessonBuilder
from kurt2rt.core.teaching.teacher_delay import BACK_TICKS, TeacherDelay

EVERY_TICKS = 10
"""Ticks of the robot between two lessons of a hold: 0.1 s."""


class Hold(NamedTuple):
    """A press of a held action and its lessons so far."""

    teacher: str
    press_id: int
    action: str
    """Action that is held, or was held last."""
    lesson: str
    """Id that undoes all lessons of the press."""
    lessons: int
    """Number of lessons that it gave."""


@dataclass(slots=True)
class _Press:
    hold: Hold
    lag_ticks: int
    """Age of the newest message's state when the message arrived."""
    earliest: int
    """Earliest tick that a lesson may be about."""
    due: int
    """Tick of the next lesson."""


class HoldLessons:
    """Builder of the lessons of a held action.

    Each 0.1 s the situation that the teacher reacted to, before the present tick by the link's lag and the delay of the
    teacher's hand, becomes a lesson with the held action, unless the robot would do that action there already.
    """

    def __init__(self, lessons: LessonBuilder, system: RlaSystem, recent: DecisionHistory, delay: TeacherDelay) -> None:
        self._lessons = lessons
        self._system = system
        self._recent = recent
        self._delay = delay
        self._press: _Press | None = None

    @property
    def newest(self) -> Hold | None:
        """Newest hold, over or not; None before the first."""
        return None if self._press is None else self._press.hold

    def begin(self, command: HoldAction, tick: int, speed: int) -> None:
        """Begin a press with its first message; `speed`: robot seconds in one second."""
        lesson = self._system.unused_hold_id(hold_id(command.teacher, command.press_id))
        asked_tick = self._delay.asked_tick
        # The teacher of a robot that asks reacts to its question, not to something before it.
        earliest = tick - BACK_TICKS * speed if asked_tick is None else asked_tick
        hold = Hold(command.teacher, command.press_id, command.action, lesson, 0)
        self._press = _Press(hold, max(0, tick - command.seen_tick), earliest, tick)

    def on_message(self, command: HoldAction, tick: int) -> None:
        """Note lag and action of a further message of the press; call it only after `begin`."""
        assert self._press is not None
        self._press.lag_ticks = max(0, tick - command.seen_tick)
        self._press.hold = self._press.hold._replace(action=command.action)

    def build(self, tick: int, phase: Phase, speed: int) -> TeachingEvent | None:
        """Return the lesson that is due in a tick of the hold; None if none is. Call it only after `begin`.

        Args:
            tick: present tick, in which the action is held.
            phase: training phase.
            speed: robot seconds in one second.
        """
        press = self._press
        assert press is not None
        hold = press.hold
        if tick < press.due:
            return None
        press.due = tick + EVERY_TICKS
        back_ticks = press.lag_ticks + self._delay.hand_ticks(hold.teacher, speed)
        meant = min(max(tick - back_ticks, press.earliest), self._recent.newest)
        if not self._recent.contains(meant) or not self._recent.teachable(meant):
            return None
        origin = Origin(f"{hold.lesson}{DERIVED}{tick}", hold.teacher, phase, tick)
        event = self._lessons.held(hold.action, meant, origin, counts=hold.lessons == 0)
        if event is not None:
            press.hold = hold._replace(lessons=hold.lessons + 1)
        return event
