"""Lessons of a held action: "hold to correct"."""

from dataclasses import dataclass

from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.lesson_history import DERIVED, hold_id
from kurt2rt.core.rla.rla import Origin, Phase
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.teaching.commands import HoldAction
from kurt2rt.core.teaching.late_press import BACK_TICKS, TeacherDelay
from kurt2rt.core.teaching.lesson_builder import LessonBuilder

EVERY_TICKS = 10
"""Ticks of the robot between two lessons of a hold: 0.1 s."""
PRESS_LESSONS = 3
"""Lessons about the mistake that led to the press."""
STEADY_TICKS = 10
"""Time before and after a reaction of the hand in which the hand must not change the action, in ticks of the robot.

A hand that follows a changing situation is now early, now late: a third of the lessons of a hold named an action that
was right 0.05 to 0.15 s before or after their situation (docs/notebook.md).
"""


@dataclass(slots=True)
class Hold:
    """Press by which a teacher holds an action to correct the robot, and its lessons so far."""

    teacher: str
    press_id: int
    action: str
    """Action that is held, or was held last."""
    lesson: str
    """Id that undoes all lessons of the press."""
    lag_ticks: int
    """Age of the newest message's state when the message arrived."""
    earliest: int
    """Earliest tick that a lesson may be about."""
    noticed: int
    """Tick of the situation in which the teacher noticed the mistake."""
    began: int
    """Tick of the first message."""
    since: int
    """Tick since which the present action is held."""
    due: int
    """Tick of the next lesson of the held action."""
    lessons: int = 0
    """Number of lessons that it gave."""
    press_lessons: int = 0
    """Number of lessons about the mistake that were due."""


class HoldLessons:
    """Builder of the lessons of a held action.

    The first three lessons are about the mistake: they name the first action for the situation in which the teacher
    noticed it, before the press by the link's lag and the delay of a correction, and for those 0.1 s and 0.2 s later.
    Then each 0.1 s the situation that the hand reacts to, earlier by the lag and the shorter delay of a hand, becomes a
    lesson with the held action. No lesson is given near a change of the held action, nor where the robot would do that
    action already.
    """

    def __init__(self, lessons: LessonBuilder, system: RlaSystem, recent: DecisionHistory, delay: TeacherDelay) -> None:
        self._lessons = lessons
        self._system = system
        self._recent = recent
        self._delay = delay
        self.newest: Hold | None = None
        """Newest hold, over or not; None before the first."""

    def begin(self, command: HoldAction, tick: int, speed: int) -> None:
        """Begin a press with its first message; `speed`: robot seconds in one second."""
        lesson = self._system.history.unused_hold_id(hold_id(command.teacher, command.press_id))
        asked_tick = self._delay.asked_tick
        # The teacher of a robot that asks reacts to its question, not to something before it.
        earliest = tick - BACK_TICKS * speed if asked_tick is None else asked_tick
        lag_ticks = max(0, tick - command.seen_tick)
        noticed = tick - lag_ticks - self._delay.correction_ticks(command.teacher, speed)
        self.newest = Hold(
            command.teacher,
            command.press_id,
            command.action,
            lesson,
            lag_ticks,
            earliest,
            max(noticed, earliest, 0),
            began=tick,
            since=tick,
            due=tick,
        )

    def on_message(self, command: HoldAction, tick: int) -> None:
        """Note lag and action of a further message of the press; call it only after `begin`."""
        hold = self.newest
        assert hold is not None
        hold.lag_ticks = max(0, tick - command.seen_tick)
        if command.action != hold.action:
            hold.action, hold.since = command.action, tick

    def next_tick(self, tick: int) -> int:
        """Return the next tick, from `tick` on, in which `build` may give a lesson. Call it only after `begin`."""
        hold = self.newest
        assert hold is not None
        if hold.press_lessons < PRESS_LESSONS and hold.since == hold.began:
            return tick
        return max(tick, hold.due)

    def build(self, tick: int, phase: Phase, speed: int) -> TeachingEvent | None:
        """Return the lesson that is due in a tick of the hold; None if none is. Call it only after `begin`.

        Args:
            tick: present tick, in which the action is held.
            phase: training phase.
            speed: robot seconds in one second.
        """
        hold = self.newest
        assert hold is not None
        meant = self._meant_tick(hold, tick, self._delay.hand_ticks(hold.teacher, speed))
        if meant is None or not self._recent.contains(meant) or not self._recent.teachable(meant):
            return None
        origin = Origin(f"{hold.lesson}{DERIVED}{tick}", hold.teacher, phase, tick)
        event = self._lessons.held(hold.action, meant, origin, counts=hold.lessons == 0)
        hold.lessons += event is not None
        return event

    def _meant_tick(self, hold: Hold, tick: int, hand_ticks: int) -> int | None:
        """Return the tick of the situation that the lesson due in `tick` is about; None if no lesson is due.

        `hand_ticks`: delay of the teacher's hand.
        """
        reacted = tick - hold.lag_ticks - hand_ticks
        if hold.press_lessons < PRESS_LESSONS and hold.since == hold.began:
            meant = hold.noticed + hold.press_lessons * EVERY_TICKS
            hold.press_lessons += 1
            return min(meant, self._recent.newest) if meant <= max(reacted, hold.noticed) else None
        if tick < hold.due:
            return None
        hold.due = tick + EVERY_TICKS
        # The first action was chosen when the mistake was noticed; the hand needs its delay to bring another one.
        unsure_ticks = hand_ticks if hold.since == hold.began else 0
        if tick - hold.since < unsure_ticks + 2 * STEADY_TICKS:
            return None
        return min(max(reacted - STEADY_TICKS, hold.earliest), self._recent.newest)
