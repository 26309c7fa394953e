"""The guard over what the critic changes: the best knowledge so far is kept, and come back to."""

from kurt2rt.critic.settings import BestSettings
from kurt2rt.rla.lesson_book import rla_of
from kurt2rt.rla.rla import (
    CRITIC,
    Appraised,
    LessonUndone,
    Origin,
    Phase,
    SessionBegun,
    SessionEnded,
    TeachingEvent,
)


class BestKnowledge:
    """Scores each window of driving, and of not knowing the way, and tells which of its changes are to be undone.

    Scores come with chance. After a roll-back the best score is that of the next window, with the knowledge that was
    come back to: else one lucky window would have everything undone that is ever learnt after it.
    """

    def __init__(self, settings: BestSettings, period_s: float) -> None:
        """`period_s` of a tick."""
        self._window_ticks = max(1, round(settings.window_s / period_s))
        self._margin = settings.margin
        self.best: float | None = None
        """Score of the best window; None before the first one has ended."""
        self.score: float | None = None
        """Score of the last window."""
        self._sum = self._driven = 0
        self._since_best: list[tuple[str, int]] = []
        """Command id and RLA of the critic's own standing changes since the best window ended, oldest first."""
        self._measure_anew = False

    def changed(self, event: TeachingEvent) -> None:
        """An event that was applied while the robot drove on its own, whoever made it."""
        match event:
            case LessonUndone(lesson, _):
                self._since_best = [each for each in self._since_best if each[0] != lesson]
            case Appraised() | SessionBegun() | SessionEnded():
                pass
            case _ if event.origin.teacher == CRITIC:
                self._since_best.append((event.origin.command_id, rla_of(event)))
            case _:  # a teacher went on from there: what stands below a lesson of his stays
                taught = rla_of(event)
                self._since_best = [each for each in self._since_best if each[1] != taught]

    def look(
        self, tick: int, opinion_value: int | None, driving: bool, *, asking: bool = False
    ) -> tuple[LessonUndone, ...]:
        """Count one tick; at the end of a window that was too bad: what to undo, in this order, newest first.

        `opinion_value`: of the critic's opinion, None where it has none, which counts as neutral. `asking`: it stands
        because it does not know the situation, which is bad, for nobody is there to be asked; to stand else is nothing.
        """
        if not driving and not asking:
            return ()
        self._sum += (opinion_value or 0) if driving else -1
        self._driven += 1
        if self._driven < self._window_ticks:
            return ()
        self.score = self._sum / self._driven
        self._sum = self._driven = 0
        return self._judge_window(self.score, tick)

    def _judge_window(self, score: float, tick: int) -> tuple[LessonUndone, ...]:
        if self._measure_anew:
            self._measure_anew = False
            self.best = score
            return ()
        if self.best is None or score >= self.best:
            self.best = score
            self._since_best.clear()
            return ()
        if score >= self.best - self._margin or not self._since_best:
            return ()
        self._measure_anew = True
        return tuple(
            LessonUndone(lesson, Origin(f"{lesson}/rolled-back", CRITIC, Phase.AUTONOMOUS, tick))
            for lesson, _ in reversed(self._since_best)
        )
