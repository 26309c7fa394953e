"""Autonomy: the critic's signals instead of a teacher's rewards (paper, phase 5)."""

from collections.abc import Iterable
from typing import NamedTuple

from kurt2rt.core.critic.agreement import Agreement
from kurt2rt.core.critic.critic import Opinion
from kurt2rt.core.critic.settings import ActivationSettings, CriticSettings, RollbackSettings
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


class ActivationMonitor:
    """Leaky mean of the share of bad driven time; at a threshold it activates the critic for the rest of phase 5.

    A critic errs at times: on a robot that drives well its errors are a small share of the time.
    """

    def __init__(self, settings: ActivationSettings, period_s: float) -> None:
        """`period_s`: duration of a tick in s."""
        self._bad_share = settings.bad_share
        self._kept = 1.0 - min(1.0, period_s / settings.mean_s)
        self._first_ticks = round(settings.first_s / period_s)
        self.reset()

    def reset(self) -> None:
        """Start phase 5: set the mean to 0, so that the critic is not active yet."""
        self.needed = False
        """Return whether the critic has to act."""
        self._bad = self._weight = 0.0
        self._ticks = 0

    @property
    def share(self) -> float:
        """Mean share of bad driven time, 0 to 1; 0 before the first drive."""
        return self._bad / self._weight if self._weight else 0.0

    def update(self, *, driving: bool, bad: bool) -> None:
        """Count one tick of phase 5; only driving ticks change the mean. `bad`: whether the critic finds it bad."""
        self._ticks += 1
        if driving:
            self._bad = self._kept * self._bad + bad
            self._weight = self._kept * self._weight + 1.0
        if self._ticks >= self._first_ticks and self.share >= self._bad_share:
            self.needed = True


class Autonomy:
    """Source of rewards in phase 5: opinions of a trusted and needed critic, at most as often as a person presses."""

    def __init__(self, settings: CriticSettings, agreement: Agreement, period_s: float) -> None:
        """`period_s`: duration of a tick in s."""
        self._agreement = agreement
        self.activation = ActivationMonitor(settings.need, period_s)
        every_s = settings.signal_every_s
        self._every_ticks = {-1: round(every_s.bad / period_s), 1: round(every_s.good / period_s)}
        self._next_tick = {-1: 0, 1: 0}
        self._patience_ticks = round(settings.patience_s / period_s)
        self._opinion_value = 0
        self._since_tick = 0
        self._last_tick = -1

    def restart(self) -> None:
        """Start phase 5: the critic is needed only after enough bad driving in this phase."""
        self.activation.reset()

    def speaks(self, tick: int, opinion: Opinion | None, driving: bool, *, listening: bool = False) -> bool:
        """Return whether the opinion of this tick is a signal, like a reward; call it in each tick of phase 5.

        False if the critic is not trusted or not needed, if its opinion is not `patience_s` old (momentary opinions are
        often chance), or if the last signal of this value is too recent.

        Args:
            tick: number of this tick.
            opinion: critic's opinion of this tick; None before its first lesson.
            driving: whether an action drives.
            listening: whether to suppress signals.
        """
        value = opinion.value if opinion is not None and driving and opinion.known else 0
        if value != self._opinion_value or tick != self._last_tick + 1:
            self._opinion_value, self._since_tick = value, tick
        self._last_tick = tick
        held = value != 0 and tick - self._since_tick >= self._patience_ticks
        self.activation.update(driving=driving, bad=held and value < 0)
        if not held or listening or not self.activation.needed:
            return False
        if tick < self._next_tick[value] or not self._agreement.trusted:
            return False
        self._next_tick[value] = tick + self._every_ticks[value]
        return True
