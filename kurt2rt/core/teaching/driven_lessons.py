"""Lessons that the teacher drives: an action that is held to correct the robot, and a drive by hand that is shown."""

import math
from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from behaviors.keep_distance import KeepDistance
from behaviors.motor_primitive import MotorPrimitive
from behaviors.repertoire import Repertoire
from behaviors.turn_by_angle import TurnByAngle
from hal.robot import SensorReadings, WheelSpeeds
from kurt2rt.core.outcome import CommandRefusedError, Outcome, RefusalCode, ResultCode
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.lesson_history import DERIVED, hold_id
from kurt2rt.core.rla.rla import Origin, Phase
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.teaching.commands import HoldAction
from kurt2rt.core.teaching.late_press import BACK_TICKS, TeacherDelay
from kurt2rt.core.teaching.lesson_builder import LessonBuilder
from kurt2rt.core.teaching.message_fields import MOST_SEGMENTS

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


CAPACITY = 600
"""Largest number of samples, the last minute; older ones are dropped."""
_LEAST_SAMPLES = 3
"""A shorter run of one action, below 0.3 s, counts as the action before it: hands shake."""
_SAME_DIRECTION = 0.05
"""Distance between unit vectors of wheel speeds up to which two directions count as equal, about 3 degrees."""
_STANDS_M_S = 0.03
"""Wheel speed below which a wheel counts as standing."""
_SHOWABLE = (MotorPrimitive, KeepDistance, TurnByAngle)
"""Actions whose speeds can be told from one reading; a taught action has knowledge and a past of its own."""
_MATCHES_PER_TICK = 4
"""Number of situations that are compared with the knowledge in one tick; the others follow in the next ticks."""


class Segment(NamedTuple):
    """Ticks of a drive by hand in a row to which the same action of the repertoire is nearest."""

    action: str
    from_tick: int
    ticks: int
    """Length of the segment in ticks."""


class _Sample(NamedTuple):
    tick: int
    row: int
    """Row of the situation that the hand reacted to."""
    action: str
    behaviour: str


class Demonstration:
    """Record of the newest drive by hand, as segments of the nearest actions, which its teacher can then teach.

    The driven speeds are compared with each action's by the angle between them. Nothing is learned before
    `TeachShown` names the right segments. It keeps the last minute, in constant memory.
    """

    def __init__(
        self, lessons: LessonBuilder, system: RlaSystem, repertoire: Repertoire, recent: DecisionHistory
    ) -> None:
        """Start without a demonstration.

        Args:
            lessons: builder of the lessons.
            system: RLAs that are taught.
            repertoire: actions that are compared with the driven speeds; used by nothing else meanwhile.
            recent: situations of the last ticks.
        """
        self._lessons = lessons
        self._system = system
        self._recent = recent
        self._repertoire = {name: each for name, each in repertoire.items() if isinstance(each, _SHOWABLE)}
        self._situations = np.full((CAPACITY, system.dimensions), np.nan)
        self._samples: deque[_Sample] = deque(maxlen=CAPACITY)
        self._count = 0
        self._began = self._due = 0
        self._last_tick = -1
        self._pending: deque[_Sample] = deque()
        self._lesson = ""
        self._origin = Origin("", "", Phase.SUPERVISED, 0)
        self.press_id: int | None = None
        """Press id of the newest manual drive; None before the first, and after it was taught or dropped."""
        self.teacher = ""
        self._segments: tuple[Segment, ...] | None = None

    def update(
        self, tick: int, press: tuple[str, int], readings: SensorReadings, speeds: WheelSpeeds, reacted: int
    ) -> None:
        """Sample a tick of manual drive.

        Args:
            tick: number of the tick.
            press: teacher and press id; a new one begins a new demonstration.
            readings: for the actions that depend on them.
            speeds: driven by the teacher.
            reacted: tick of the situation that the teacher's hand reacted to.
        """
        if press != (self.teacher, self.press_id):
            self.teacher, self.press_id = press
            self._samples.clear()
            self._pending.clear()
            self._count, self._began, self._due = 0, tick, tick
        self._last_tick = tick
        if tick < self._due:
            return
        # At first the hand reacts to the place where the robot stood.
        meant = min(max(reacted, self._began), self._recent.newest)
        if not self._recent.contains(meant) or not self._recent.has_situation(meant):
            return
        self._due = tick + EVERY_TICKS
        row = self._count % CAPACITY
        self._count += 1
        self._situations[row] = self._recent.situation(meant)
        action = nearest_action(self._repertoire, readings, speeds)
        self._samples.append(_Sample(tick, row, action, self._recent.behaviour(meant)))
        self._segments = None

    def segments(self, tick: int) -> tuple[Segment, ...]:
        """Return the segments of the last press at `tick`, oldest first, at most MOST_SEGMENTS.

        Returns () while the press lasts.
        """
        if self.press_id is None or tick <= self._last_tick + 1 or self._pending:
            return ()
        if self._segments is None:
            self._samples = deque(_steady(self._samples), maxlen=CAPACITY)
            self._segments = tuple(_segments(self._samples))[-MOST_SEGMENTS:]
        return self._segments

    def confirm(self, press_id: int, chosen: Iterable[int], origin: Origin) -> Outcome:
        """Begin to teach segments of the demonstration; `next_lesson` returns them one by one.

        Args:
            press_id: press that the teacher saw.
            chosen: indexes into `segments`.
            origin: of the command.

        Raises:
            CommandRefusedError: the demonstration or a segment is not there (any more).
        """
        segments = self.segments(origin.tick)
        if press_id != self.press_id or origin.teacher != self.teacher or not segments:
            raise CommandRefusedError(RefusalCode.NO_DEMONSTRATION)
        indexes = sorted(set(chosen))
        if not indexes or not 0 <= indexes[0] <= indexes[-1] < len(segments):
            raise CommandRefusedError(RefusalCode.NO_SEGMENT, segments=len(segments))
        first, last = segments[0].from_tick, segments[-1].from_tick + segments[-1].ticks
        spans = [_steady_span(segments[index], first, last) for index in indexes]
        self._pending.extend(each for each in self._samples if any(each.tick in span for span in spans))
        self._lesson = self._system.history.unused_hold_id(hold_id(self.teacher, press_id))
        self._origin = origin
        self.press_id = None
        return Outcome.of(
            ResultCode.DEMONSTRATION_TAUGHT, segments=len(spans), situations=len(self._pending), lesson=self._lesson
        )

    def cancel(self) -> None:
        """Drop the lessons that have not been given yet; call it when the teacher undoes a lesson."""
        self._pending.clear()

    @property
    def pending(self) -> bool:
        """Return whether lessons of a confirmed demonstration have not been given yet."""
        return bool(self._pending)

    def next_lesson(self, tick: int) -> TeachingEvent | None:
        """Return the next lesson of a confirmed demonstration; None if none is due.

        A situation in which the robot would do the shown action already gives no lesson.
        """
        for _ in range(_MATCHES_PER_TICK):
            if not self._pending:
                return None
            sample = self._pending.popleft()
            origin = replace(self._origin, command_id=f"{self._lesson}{DERIVED}{sample.tick}", tick=tick)
            event = self._lessons.shown(sample.action, self._situations[sample.row], sample.behaviour, origin)
            if event is not None:
                return event
        return None


def _steady_span(segment: Segment, first: int, last: int) -> range:
    """Return the ticks of a segment without those near a change of the action, as in a hold.

    `first`, `last`: ends of the whole demonstration in ticks, where the action does not change.
    """
    begin, end = segment.from_tick, segment.from_tick + segment.ticks
    return range(begin + STEADY_TICKS * (begin > first), end - STEADY_TICKS * (end < last))


def nearest_action(repertoire: Repertoire, readings: SensorReadings, speeds: WheelSpeeds) -> str:
    """Return the name of the action whose wheel speeds have the direction that is nearest to the driven ones.

    The direction counts first, so that a teacher may show slowly; of actions with about that direction, such as forward
    and flee, the one with the nearest speeds.
    """
    driven = _direction(speeds)

    def difference(name: str) -> tuple[int, float]:
        behaviour = repertoire[name]
        behaviour.start()
        own = behaviour.step(readings)
        turned = math.dist(_direction(own), driven)
        return int(turned / _SAME_DIRECTION), math.dist(own, speeds)

    return min(repertoire, key=difference)


def _direction(speeds: WheelSpeeds) -> tuple[float, float]:
    left, right = speeds.left_m_s, speeds.right_m_s
    length = math.hypot(left, right)
    return (0.0, 0.0) if length < _STANDS_M_S else (left / length, right / length)


def _steady(samples: Iterable[_Sample]) -> list[_Sample]:
    """Return the samples with short runs of an action joined to the run before them, or after the first."""
    runs: list[list[_Sample]] = []
    for sample in samples:
        if runs and runs[-1][0].action == sample.action:
            runs[-1].append(sample)
        else:
            runs.append([sample])
    long_ = next((run[0].action for run in runs if len(run) >= _LEAST_SAMPLES), None)
    steady: list[_Sample] = []
    for run in runs:
        action = run[0].action
        if len(run) < _LEAST_SAMPLES:
            action = steady[-1].action if steady else long_ or action
        steady.extend(each._replace(action=action) for each in run)
    return steady


def _segments(samples: Sequence[_Sample]) -> Iterable[Segment]:
    """Yield the runs of one action; each lasts until the next begins."""
    begin = 0
    for index in range(1, len(samples) + 1):
        if index == len(samples) or samples[index].action != samples[begin].action:
            end = samples[index].tick if index < len(samples) else samples[-1].tick + EVERY_TICKS
            yield Segment(samples[begin].action, samples[begin].tick, end - samples[begin].tick)
            begin = index
