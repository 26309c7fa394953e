"""The guard over what the critic changes: the best knowledge so far is kept, and come back to."""

from collections.abc import Iterable
from typing import NamedTuple

from kurt2rt.core.critic.settings import RollbackSettings
from kurt2rt.core.rla.lesson_history import rla_id_of
from kurt2rt.core.rla.rla import (
    CRITIC,
    Appraised,
    KnowledgeMerged,
    LessonRedone,
    LessonUndone,
    Origin,
    Phase,
    SessionBegun,
    SessionEnded,
    SituationNamed,
    TeachingEvent,
)


class _Change(NamedTuple):
    """A standing change of the critic's own."""

    lesson: str
    """Its command id."""
    rla_id: int
    number: int
    """Among all teaching events, from 1."""


class RollbackMonitor:
    """Scores each window of driving, and of not knowing the way, and tells which of its changes are to be undone.

    Scores come with chance, so knowledge is measured while nothing changes it: in the first window of phase 5, and in
    the one after a roll-back, whose score is the best from then on: else one lucky window would have everything undone
    that is ever learnt after it. A window that is won proves what was changed before it began, and no more.
    """

    def __init__(self, settings: RollbackSettings, period_s: float) -> None:
        """`period_s` of a tick."""
        self._window_ticks = max(1, round(settings.window_s / period_s))
        self._margin = settings.margin
        self.best: float | None = None
        """Score of the best window; None before the first one has ended, and after a roll-back."""
        self.includes = 0
        """How many teaching events there were when the best window began: what the critic changed later is unproven."""
        self.score: float | None = None
        """Score of the last window."""
        self.windows_won = 0
        """How many windows were won."""
        self.is_measuring = True
        """Whether knowledge is measured as it is: in this window the critic changes nothing."""
        self._sum = self._counted = 0
        self._events = 0
        """How many teaching events there were."""
        self._window_from = 0
        """How many there were when the window began."""
        self._unproven: list[_Change] = []
        """Oldest first."""

    def restore(self, events: Iterable[TeachingEvent], best: float | None, includes: int) -> None:
        """Go on from another run: all its events, and what `best` and `includes` were at its end."""
        for event in events:
            self.on_event(event)
        self.best, self.includes = best, includes
        # Knowledge without a best is measured as it is.
        self._unproven = [] if best is None else [each for each in self._unproven if each.number > includes]

    def restart(self) -> None:
        """The robot is alone from now on: what counted before may have been elsewhere, so it is measured first."""
        self.is_measuring = True
        self._sum = self._counted = 0

    def on_event(self, event: TeachingEvent) -> None:
        """An event that was applied, whoever made it, and in whichever phase."""
        self._events += 1
        match event:
            case LessonUndone(lesson, _):
                self._unproven = [each for each in self._unproven if each.lesson != lesson]
            case Appraised() | SituationNamed() | SessionBegun() | SessionEnded() | KnowledgeMerged():
                pass
            case LessonRedone():  # a person wants it back, whoever it was from: it needs no proof
                pass
            case _ if event.origin.teacher == CRITIC:
                self._unproven.append(_Change(event.origin.command_id, rla_id_of(event), self._events))
            case _:  # a teacher went on from there: what stands below a lesson of his stays
                taught = rla_id_of(event)
                self._unproven = [each for each in self._unproven if each.rla_id != taught]

    def update(
        self, tick: int, opinion_value: int | None, answers: bool, *, asking: bool = False
    ) -> tuple[LessonUndone, ...]:
        """Count one tick; at the end of a window that was too bad: what to undo, in this order, newest first.

        `opinion_value`: of the critic's opinion, None where it has none, which counts as neutral. `answers`: whether an
        RLA answers that knows the situation; what a teacher's hand does is not the merit of the knowledge. `asking`: it
        stands because it does not know the situation, which is bad, for nobody is there to be asked; to stand else is
        nothing.
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
