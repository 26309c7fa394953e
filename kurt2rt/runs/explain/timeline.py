"""Timeline of a run: stretches of driving, being led, asking and standing."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import StrEnum
from itertools import groupby
from typing import NamedTuple

from hal.odometry import PlanePose, WheelOdometry
from hal.robot_settings import RobotSettings
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.rla.events import (
    Appraised,
    Lesson,
    LessonRedone,
    LessonUndone,
    RlaCreated,
    SessionBegun,
    SessionEnded,
    SituationNamed,
    TeachingEvent,
)
from kurt2rt.core.rla.lesson_history import LessonRecord, rla_id_of
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.runs.explain.sentences import format_count
from kurt2rt.runs.recording.entries import DecisionEntry, TickEntry

MOST_SAMPLES = 5000
"""Samples kept of a run, up to twice as many: a picture is no wider."""


_TOUCHES = "asks: touches something"


class Kind(StrEnum):
    """Kind of a stretch of a run: the robot drove by RLAs, was led, asked, or stood for another reason."""

    DRIVES = "drives"
    """Driving by RLAs."""
    LED = "led"
    """Driven by a teacher."""
    ASKS = "asks"
    STANDS = "stands"
    """Standing for another reason than a question."""


@dataclass(slots=True)
class Stretch:
    """Consecutive ticks of a run in which the robot did one thing; it grows while the run is read."""

    kind: Kind
    what: str
    """Action, or the cause of standing."""
    behaviour: str
    """Active taught behaviour; empty if there is only one."""
    from_s: float
    """Time from the first tick of the run."""
    to_s: float
    rlas: dict[int, int] = field(default_factory=dict)
    """Ticks by RLA id: driving, or nearest while the robot asked or stood."""
    worst: float = 0.0
    """Largest distance as a fraction of R; infinite if no RLA was near."""
    guarded: dict[str, int] = field(default_factory=dict)
    """Ticks in which the guard changed the decision, by reason; without the slew limit."""

    @property
    def lasts_s(self) -> float:
        """Length of the interval in s."""
        return self.to_s - self.from_s


@dataclass(frozen=True, slots=True)
class Note:
    """Lesson, alarm or other event of a run that its timeline marks, at the time of its tick."""

    at_s: float
    kind: str
    """lesson, saying (a session, an appraisal, an undo) or alarm."""
    text: str


@dataclass(frozen=True, slots=True)
class Sample:
    """Values of one tick for the curves of a timeline: speeds, place, and nearness of the RLA."""

    at_s: float
    share: float
    """Distance of the nearest RLA as a fraction of R; NaN without one."""
    rla_id: int | None
    """Driving RLA; None without one."""
    action: str | None
    left_m_s: float
    """Speed after the guard."""
    right_m_s: float
    held_back: bool
    """True if the guard changed the decision for another reason than its slew limit."""
    x_m: float
    """Dead-reckoned pose; the first tick is at the origin, heading along x."""
    y_m: float
    heading_rad: float


@dataclass(frozen=True, slots=True)
class Timeline:
    """Course of a recorded run or a part of it, for tables and pictures: stretches, notes and curves."""

    stretches: tuple[Stretch, ...]
    notes: tuple[Note, ...]
    samples: tuple[Sample, ...]
    ticks: int
    missed: int
    """Ticks that were skipped."""
    unrecorded: int = 0
    """Ticks that ran but are not in the recording."""
    surprised_s: float | None = None
    """Time of the greatest surprise; None if there was none."""
    outline_m: tuple[float, float] = (0.0, 0.0)
    """Length and width of the robot."""

    @property
    def from_s(self) -> float:
        """Time of the first tick in s."""
        return self.stretches[0].from_s if self.stretches else 0.0

    @property
    def to_s(self) -> float:
        """End of the last tick in s."""
        return self.stretches[-1].to_s if self.stretches else 0.0


def build_timeline(
    entries: Iterable[TickEntry],
    robot: RobotSettings,
    *,
    from_s: float = 0.0,
    to_s: float = math.inf,
    every: int = 5,
    known: Iterable[TeachingEvent] = (),
) -> Timeline:
    """Build the timeline from the entries of a run, oldest first; times in s from its first tick.

    Every `every`-th tick is sampled, fewer in a long run: at most 2 MOST_SAMPLES. `known`: lessons from before the run.
    """
    reader = _Reader(robot, from_s, to_s, every)
    for event in known:
        reader.lessons.describe(event)
    for entry in entries:
        if not reader.update(entry):
            break
    return reader.timeline


class LessonDescriber:
    """Description of teaching events that remembers earlier lessons, to name them in an undo or redo."""

    def __init__(self) -> None:
        self._texts: dict[str, str] = {}
        self._home_of: dict[int, tuple[str, str]] = {}
        """Behaviour and level of each RLA."""

    def describe(self, event: TeachingEvent) -> str:
        """Return the event in a few words, with its teacher."""
        by = event.origin.teacher
        match event:
            case LessonUndone(lesson):
                return f"undone: {self._texts.get(lesson, 'a lesson')} ({by})"
            case LessonRedone(lesson):
                return f"redone: {self._texts.get(lesson, 'a lesson')} ({by})"
            case SessionBegun(name):
                return f"session {name} begun by {by}"
            case SessionEnded():
                return f"session ended by {by}"
            case Appraised(appraisal):
                return f"called {appraisal} ({by})"
            case RlaCreated(rla):
                self._home_of[rla.rla_id] = rla.behaviour, rla.level
        behaviour, level = (
            ("", BASIC) if isinstance(event, SituationNamed) else self._home_of.get(rla_id_of(event), ("", BASIC))
        )
        text = LessonRecord(event, behaviour=behaviour, level=level).text
        self._texts[event.origin.command_id] = text
        return f"{text} ({by})"


class _Reader:
    """Incremental builder of a timeline."""

    def __init__(self, robot: RobotSettings, from_s: float, to_s: float, every: int) -> None:
        self._robot, self._period_s = robot, robot.cycle_s
        self._odometry = WheelOdometry(robot.geometry)
        self._pose = PlanePose()
        self._from_s, self._to_s, self._every = from_s, to_s, every
        self._began_s: float | None = None
        self._stretches: list[Stretch] = []
        self._notes: list[Note] = []
        self._samples: list[Sample] = []
        self._ticks = self._missed = self._unrecorded = 0
        self._before: TickEntry | None = None
        self._latched = False
        self._surprised_s: float | None = None
        self._surprise = 0.0
        self.lessons = LessonDescriber()

    @property
    def timeline(self) -> Timeline:
        return Timeline(
            tuple(self._stretches),
            tuple(self._notes),
            tuple(self._samples),
            self._ticks,
            self._missed,
            self._unrecorded,
            self._surprised_s,
            self._robot.geometry.outline_m,
        )

    def update(self, entry: TickEntry) -> bool:
        """Add one tick; return False after the end of the requested time."""
        if self._began_s is None:
            self._began_s = entry.now_s
        at_s = entry.now_s - self._began_s
        self._update_pose(entry)
        told = [(_kind(event), self.lessons.describe(event)) for event in entry.events]
        if at_s > self._to_s:
            return False
        if at_s < self._from_s:
            return True
        unrecorded = 0
        if self._before is not None:
            unrecorded = max(0, entry.number - self._before.number - 1)
            self._unrecorded += unrecorded
            self._missed += max(0, entry.tick - self._before.tick - 1 - unrecorded)
        self._before = entry
        kind, what = _classified(entry)
        last = self._stretches[-1] if self._stretches else None
        if last is None or unrecorded or (last.kind, last.what, last.behaviour) != (kind, what, entry.behaviour):
            if last is not None and not unrecorded:
                last.to_s = at_s
            last = Stretch(kind, what, entry.behaviour, at_s, at_s)
            self._stretches.append(last)
        last.to_s = at_s + self._period_s
        self._count(last, entry)
        self._note(entry, told, at_s)
        if entry.surprise is not None and entry.surprise.surprising and entry.surprise.multiple > self._surprise:
            self._surprised_s, self._surprise = at_s, entry.surprise.multiple
        if self._ticks % self._every == 0:
            self._samples.append(self._sample(entry, at_s))
            if len(self._samples) == 2 * MOST_SAMPLES:
                del self._samples[1::2]
                self._every *= 2
        self._ticks += 1
        return True

    def _update_pose(self, entry: TickEntry) -> None:
        motion = self._odometry.motion(entry.readings.encoder_left_ticks, entry.readings.encoder_right_ticks)
        self._pose = self._pose.moved(motion.forward_m, motion.turn_rad)

    def _count(self, stretch: Stretch, entry: TickEntry) -> None:
        decision = entry.decision
        nearest = None if decision.match is None else decision.match.rla_id
        rla_id = nearest if decision.rla_id is None else decision.rla_id
        if rla_id is not None:
            stretch.rlas[rla_id] = stretch.rlas.get(rla_id, 0) + 1
        share = _share(decision)
        if not math.isnan(share):
            stretch.worst = max(stretch.worst, share)
        for reason in _notable_reasons(entry):
            stretch.guarded[reason] = stretch.guarded.get(reason, 0) + 1

    def _note(self, entry: TickEntry, told: Iterable[tuple[str, str]], at_s: float) -> None:
        self._notes += [Note(at_s, kind, text) for kind, text in told]
        if entry.grant.latched and not self._latched:
            self._notes.append(Note(at_s, "alarm", ", ".join(entry.grant.reasons)))
        self._latched = entry.grant.latched

    def _sample(self, entry: TickEntry, at_s: float) -> Sample:
        return Sample(
            at_s=at_s,
            share=_share(entry.decision),
            rla_id=entry.decision.rla_id,
            action=entry.decision.action,
            left_m_s=entry.grant.wheel_speeds.left_m_s,
            right_m_s=entry.grant.wheel_speeds.right_m_s,
            held_back=bool(_notable_reasons(entry)),
            x_m=self._pose.x_m,
            y_m=self._pose.y_m,
            heading_rad=self._pose.heading_rad,
        )


class Moment(NamedTuple):
    """Moment of a run to explain, and what makes it telling."""

    at_s: float
    """Time from the first tick of the run."""
    what: str


def telling_moment(timeline: Timeline) -> Moment | None:
    """Return the last touch; without one the last question, the greatest surprise or the last change of action.

    None for a timeline without a tick.
    """
    asked = [each for each in timeline.stretches if each.kind is Kind.ASKS]
    if touched := [each for each in asked if each.what == _TOUCHES]:
        return Moment(touched[-1].from_s, "its last touch")
    if asked:
        return Moment(asked[-1].from_s, "its last question")
    if timeline.surprised_s is not None:
        return Moment(timeline.surprised_s, "its greatest surprise")
    driven = [each for each in timeline.stretches if each.kind is Kind.DRIVES] or timeline.stretches
    return Moment(driven[-1].from_s, "its last change") if driven else None


def kind_intervals(timeline: Timeline, kind: Kind) -> tuple[tuple[float, float], ...]:
    """Return the intervals (from, to) in s of one kind, adjoining stretches merged."""
    groups = [tuple(group) for each, group in groupby(timeline.stretches, lambda stretch: stretch.kind) if each is kind]
    return tuple((group[0].from_s, group[-1].to_s) for group in groups)


def format_summary(timeline: Timeline) -> str:
    """Return the shares of driving, asking and standing in one line."""
    whole_s = timeline.to_s - timeline.from_s
    if not whole_s > 0:
        return "Nothing was recorded in that time."
    words = {Kind.DRIVES: "drove by its RLAs", Kind.LED: "was led", Kind.ASKS: "asked", Kind.STANDS: "stood"}
    shares = []
    for kind, word in words.items():
        lasts_s = sum(stretch.lasts_s for stretch in timeline.stretches if stretch.kind is kind)
        if lasts_s > 0:
            often = (
                f" ({format_count(len(kind_intervals(timeline, kind)))})" if kind in (Kind.ASKS, Kind.STANDS) else ""
            )
            shares.append(f"{word} {100 * lasts_s / whole_s:.0f} %{often}")
    lessons = sum(note.kind == "lesson" for note in timeline.notes)
    alarms = sum(note.kind == "alarm" for note in timeline.notes)
    counts = [_counted(lessons, "lesson")] if lessons else []
    counts += [_counted(alarms, "alarm")] if alarms else []
    counts += [f"{timeline.missed} ticks missed"] if timeline.missed else []
    counts += [f"{timeline.unrecorded} ticks not recorded"] if timeline.unrecorded else []
    return f"{whole_s:.1f} s: {', '.join(shares)}{'. ' if shares and counts else ''}{', '.join(counts)}"


def _kind(event: TeachingEvent) -> str:
    return "lesson" if isinstance(event, Lesson) else "saying"


def _counted(count: int, what: str) -> str:
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def _classified(entry: TickEntry) -> tuple[Kind, str]:
    decision = entry.decision
    if entry.grant.latched:
        return Kind.STANDS, f"guard: {', '.join(entry.grant.reasons)}"
    if decision.action is not None:
        return (Kind.LED if decision.cause is DecisionCause.TEACHER else Kind.DRIVES), decision.action
    if decision.cause is DecisionCause.TOUCHES:
        return Kind.ASKS, _TOUCHES
    if decision.cause is DecisionCause.DOUBT:
        return Kind.ASKS, "asks: doubts"
    if decision.cause is DecisionCause.UNKNOWN:
        return Kind.ASKS, "asks the way" if decision.asks_at != BASIC else "asks"
    return Kind.STANDS, decision.cause.value


def _notable_reasons(entry: TickEntry) -> tuple[str, ...]:
    """Return the guard's reasons except the slew limit at each change of action."""
    return tuple(reason for reason in entry.grant.reasons if not reason.routine)


def _share(decision: DecisionEntry) -> float:
    match = decision.match
    return math.nan if match is None or not match.radius > 0 else match.distance / match.radius
