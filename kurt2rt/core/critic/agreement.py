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
        self._heard: dict[int, deque[tuple[str, bool]]] = {value: deque(maxlen=settings.window) for value in (-1, 0, 1)}
        """Of each value of the teacher's: command id, and whether the critic had said the same."""
        self._taken_back: dict[str, list[tuple[int, bool]]] = {}
        """What was heard in lessons that were undone, by command id: the teacher's value, and whether it was right."""
        self._critics: set[int] = set()
        """Ids of all appraisal RLAs that ever lived."""
        self.share: float | None = None
        """Agreement: mean over the values of their shares; None while too few bad or good signals were heard.

        Neutral ones count as soon as there are enough of them, too.
        """

    @property
    def trusted(self) -> bool:
        """Whether the critic may act."""
        return self.share is not None and self.share >= self._settings.bound

    def hear(self, event: TeachingEvent) -> None:
        """Take in an event of the journal, or one that was just made."""
        match event:
            case LessonUndone(lesson, _):
                self._forget(lesson)
                return
            case LessonRedone(lesson, _):
                self._heed_again(lesson)
                return
            case RlaCreated(rla) if rla.level == CRITIC:
                self._critics.add(rla.rla_id)
        if event.origin.teacher == CRITIC:  # of itself it thinks well
            return
        match event:
            case RlaCreated(rla) if rla.level == CRITIC:
                self._note(self._values.get(rla.action), event, right=False)
            case ActionReplaced(rla_id, action, _, _) if rla_id in self._critics:
                self._note(self._values.get(action), event, right=False)
            case Appraised(_, value, _, _):
                self._note(value, event, right=True)
            case RlaRewarded() if self._critics:
                self._note(event.value, event, right=event.said == event.value)

    def hear_all(self, events: Iterable[TeachingEvent]) -> None:
        """Take in events in order."""
        for event in events:
            self.hear(event)

    def heard_of(self, value: int) -> int:
        """How many signals of a value count."""
        return len(self._heard[value])

    def share_of(self, value: int) -> float | None:
        """Share of the signals of a value in which it agreed; None where none was heard."""
        heard = self._heard[value]
        return sum(right for _, right in heard) / len(heard) if heard else None

    def _note(self, value: int | None, event: TeachingEvent, *, right: bool) -> None:
        if value is None or self._too_soon(event.origin.tick):  # None: taught with what these settings do not have
            return
        self._counted_at = event.origin.tick
        self._heard[value].append((event.origin.command_id, right))
        self._sum_up()

    def _too_soon(self, tick: int) -> bool:
        """Whether a signal comes so soon after one that counts that it says nothing new; ticks begin anew each run."""
        return self._counted_at is not None and 0 <= tick - self._counted_at < self._apart_ticks

    def _forget(self, lesson: str) -> None:
        """What was taken back was never said."""
        for value, heard in self._heard.items():
            for each in [each for each in heard if each[0] == lesson]:
                heard.remove(each)
                self._taken_back.setdefault(lesson, []).append((value, each[1]))
        self._sum_up()

    def _heed_again(self, lesson: str) -> None:
        """What stands again was said, as the newest."""
        for value, right in self._taken_back.pop(lesson, ()):
            self._heard[value].append((lesson, right))
        self._sum_up()

    def _sum_up(self) -> None:
        """Here and not when it is asked for: that is in every tick."""
        enough = [value for value in (-1, 0, 1) if self.heard_of(value) >= self._settings.least]
        shares = [share for share in map(self.share_of, enough) if share is not None]
        self.share = sum(shares) / len(shares) if {-1, 1} <= set(enough) else None
