"""How far the critic agrees with its teacher, measured on signals it was not taught with."""

from collections import deque
from collections.abc import Iterable, Mapping

from kurt2rt.core.critic.settings import AgreementSettings
from kurt2rt.core.rla.rla import (
    CRITIC,
    ActionReplaced,
    Appraised,
    LessonRedone,
    LessonUndone,
    RlaCreated,
    RlaRewarded,
    TeachingEvent,
)


class Agreement:
    """A fold of teaching events: what the teacher said of a tick against what the critic had said of it before.

    An appraisal that taught something is a disagreement, for only another opinion than the critic's is learnt. Not to
    know is no agreement either. What is said before the critic has its first appraisal counts for nothing, nor does
    what is said soon after a signal that counts: the critic has just been taught about such a place.
    """

    def __init__(self, settings: AgreementSettings, appraisals: Mapping[str, int], period_s: float) -> None:
        """`appraisals`: value of each by its name. `period_s` of a tick."""
        self._settings = settings
        self._values = dict(appraisals)
        self._apart_ticks = round(settings.apart_s / period_s)
        self._counted_at: int | None = None
        """Tick in which the last signal that counts was heard."""
        self._signals: dict[int, deque[tuple[str, bool]]] = {
            value: deque(maxlen=settings.window) for value in (-1, 0, 1)
        }
        """Of each value of the teacher's: command id, and whether the critic had said the same."""
        self._undone: dict[str, list[tuple[int, bool]]] = {}
        """What was heard in lessons that were undone, by command id: the teacher's value, and whether it was right."""
        self._appraisal_rlas: set[int] = set()
        """Ids of all appraisal RLAs that ever lived."""
        self.share: float | None = None
        """Agreement: mean over the values of their shares; None while too few bad or good signals were heard.

        Neutral ones count as soon as there are enough of them, too.
        """

    @property
    def trusted(self) -> bool:
        """Whether the critic may act."""
        return self.share is not None and self.share >= self._settings.bound

    def on_event(self, event: TeachingEvent) -> None:
        """Take in an event of the journal, or one that was just made."""
        match event:
            case LessonUndone(lesson, _):
                self._remove(lesson)
                return
            case LessonRedone(lesson, _):
                self._restore(lesson)
                return
            case RlaCreated(rla) if rla.level == CRITIC:
                self._appraisal_rlas.add(rla.rla_id)
        if event.origin.teacher == CRITIC:  # of itself it thinks well
            return
        match event:
            case RlaCreated(rla) if rla.level == CRITIC:
                self._add(self._values.get(rla.action), event, right=False)
            case ActionReplaced(rla_id, action, _, _) if rla_id in self._appraisal_rlas:
                self._add(self._values.get(action), event, right=False)
            case Appraised(_, value, _, _):
                self._add(value, event, right=True)
            case RlaRewarded() if self._appraisal_rlas:
                self._add(event.value, event, right=event.said == event.value)

    def replay(self, events: Iterable[TeachingEvent]) -> None:
        """Take in events in order."""
        for event in events:
            self.on_event(event)

    def count_for(self, value: int) -> int:
        """How many signals of a value count."""
        return len(self._signals[value])

    def share_for(self, value: int) -> float | None:
        """Share of the signals of a value in which it agreed; None where none was heard."""
        heard = self._signals[value]
        return sum(right for _, right in heard) / len(heard) if heard else None

    def _add(self, value: int | None, event: TeachingEvent, *, right: bool) -> None:
        if value is None or self._too_soon(event.origin.tick):  # None: taught with what these settings do not have
            return
        self._counted_at = event.origin.tick
        self._signals[value].append((event.origin.command_id, right))
        self._update_share()

    def _too_soon(self, tick: int) -> bool:
        """Whether a signal comes so soon after one that counts that it says nothing new; ticks begin anew each run."""
        return self._counted_at is not None and 0 <= tick - self._counted_at < self._apart_ticks

    def _remove(self, lesson: str) -> None:
        """What was taken back was never said."""
        for value, heard in self._signals.items():
            for each in [each for each in heard if each[0] == lesson]:
                heard.remove(each)
                self._undone.setdefault(lesson, []).append((value, each[1]))
        self._update_share()

    def _restore(self, lesson: str) -> None:
        """What stands again was said, as the newest."""
        for value, right in self._undone.pop(lesson, ()):
            self._signals[value].append((lesson, right))
        self._update_share()

    def _update_share(self) -> None:
        """Here and not when it is asked for: that is in every tick."""
        enough = [value for value in (-1, 0, 1) if self.count_for(value) >= self._settings.least]
        shares = [share for share in map(self.share_for, enough) if share is not None]
        self.share = sum(shares) / len(shares) if {-1, 1} <= set(enough) else None
