"""Demonstration: what a teacher drove by hand, as actions of the repertoire that can be taught."""

import math
from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import replace
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
from kurt2rt.core.teaching.hold_lessons import EVERY_TICKS, STEADY_TICKS
from kurt2rt.core.teaching.lesson_builder import LessonBuilder
from kurt2rt.core.teaching.message_fields import MOST_SEGMENTS

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
