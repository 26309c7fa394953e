"""Rollback of the critic's changes to the best knowledge so far."""

from collections.abc import Iterable
from typing import NamedTuple

from kurt2rt.core.critic.settings import RollbackSettings
from kurt2rt.core.rla.events import (
    Appraised,
    LessonRedone,
    LessonUndone,
    SessionBegun,
    SessionEnded,
    SituationNamed,
    TeachingEvent,
)
from kurt2rt.core.rla.lesson_history import rla_id_of
from kurt2rt.core.rla.rla import CRITIC, Origin, Phase


class _Change(NamedTuple):
    """Standing lesson of the critic."""

    lesson: str
    """Command id."""
    rla_id: int
    number: int
    """Number among all teaching events, from 1."""


class RollbackMonitor:
    """Score of each window of driving, and choice of the critic's lessons to undo after a bad one.

    Scores vary by chance. So knowledge is measured unchanged in the first window of phase 5 and in the window after
    a rollback; that score is the new best one. Otherwise one lucky window would undo all later lessons. A window with
    a best score proves the lessons before its beginning.
    """

    def __init__(self, settings: RollbackSettings, period_s: float) -> None:
        """`period_s`: duration of a tick in s."""
        self._window_ticks = max(1, round(settings.window_s / period_s))
        self._margin = settings.margin
        self.best: float | None = None
        """Score of the best window; None before the end of the first one, and after a rollback."""
        self.includes = 0
        """Number of teaching events at the beginning of the best window; later lessons of the critic are unproven."""
        self.score: float | None = None
        """Score of the last window, -1 to 1."""
        self.windows_won = 0
        """Number of windows with a best score."""
        self.is_measuring = True
        """Return whether this window measures unchanged knowledge: the critic changes nothing."""
        self._sum = self._counted = 0
        self._events = 0
        """Number of teaching events so far."""
        self._window_from = 0
        """Number of teaching events at the beginning of the window."""
        self._unproven: list[_Change] = []
        """Oldest first."""

    def restore(self, events: Iterable[TeachingEvent], best: float | None, includes: int) -> None:
        """Restore the state at the end of an earlier run.

        Args:
            events: all teaching events so far, oldest first.
            best: score of the best window, -1 to 1, dimensionless; None: no window has ended.
            includes: number of events at the beginning of the best window; later lessons of the critic are unproven.
        """
        for event in events:
            self.on_event(event)
        self.best, self.includes = best, includes
        self._unproven = [] if best is None else [each for each in self._unproven if each.number > includes]

    def restart(self) -> None:
        """Start phase 5: discard the open window and measure one window before changing anything."""
        self.is_measuring = True
        self._sum = self._counted = 0

    def on_event(self, event: TeachingEvent) -> None:
        """Count an applied event of any teacher and phase, and note a lesson of the critic as unproven."""
        self._events += 1
        match event:
            case LessonUndone(lesson, _):
                self._unproven = [each for each in self._unproven if each.lesson != lesson]
            case Appraised() | SituationNamed() | SessionBegun() | SessionEnded():
                pass
            case LessonRedone():  # a person's decision needs no proof
                pass
            case _ if event.origin.teacher == CRITIC:
                self._unproven.append(_Change(event.origin.command_id, rla_id_of(event), self._events))
            case _:  # lessons below a teacher's lesson stay
                taught = rla_id_of(event)
                self._unproven = [each for each in self._unproven if each.rla_id != taught]

    def update(
        self, tick: int, opinion_value: int | None, answers: bool, *, asking: bool = False
    ) -> tuple[LessonUndone, ...]:
        """Count one tick; return the undos, newest first, at the end of a bad window.

        Args:
            tick: number of this tick.
            opinion_value: -1, 0 or +1 of the critic's opinion; None counts as 0.
            answers: whether an RLA inside its radius drives; manual driving does not count.
            asking: whether the robot stands in an unknown situation: counts as -1, because no teacher answers.
        """
        if not answers and not asking:
            return ()
        if self._counted == 0:
            self._window_from = self._events
        self._sum += (opinion_value or 0) if answers else -1
        self._counted += 1
        if self._counted < self._window_ticks:
            return ()
        self.score = self._sum / self._counted
        self._sum = self._counted = 0
        return self._judge_window(self.score, tick)

    def _judge_window(self, score: float, tick: int) -> tuple[LessonUndone, ...]:
        measured, self.is_measuring = self.is_measuring, False
        nothing_to_prove = measured and not self._unproven
        if self.best is None or score >= self.best or nothing_to_prove:
            self.best, self.includes = score, self._window_from
            self.windows_won += 1
            self._unproven = [each for each in self._unproven if each.number > self._window_from]
            return ()
        if score >= self.best - self._margin or not self._unproven:
            return ()
        undone, self._unproven = self._unproven, []
        self.best, self.is_measuring = None, True
        return tuple(
            LessonUndone(each.lesson, Origin(f"{each.lesson}/rolled-back", CRITIC, Phase.AUTONOMOUS, tick))
            for each in reversed(undone)
        )
