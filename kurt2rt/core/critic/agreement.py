"""Agreement of the critic with its teacher, measured on signals that did not train it."""

from collections import deque
from collections.abc import Iterable, Mapping
from fractions import Fraction

from kurt2rt.core.critic.settings import AgreementSettings
from kurt2rt.core.rla.events import (
    ActionReplaced,
    Appraised,
    LessonRedone,
    LessonUndone,
    RlaCreated,
    RlaRewarded,
    TeachingEvent,
)
from kurt2rt.core.rla.rla import CRITIC


class Agreement:
    """Fold of teaching events: the teacher's signal about a tick against the critic's earlier opinion of that tick.

    An appraisal that teaches an RLA is a disagreement, and so is a reward without an opinion. Signals before the first
    appraisal do not count, nor do those within `apart_s` of a counted one: they would measure what was just taught.
    """

    def __init__(self, settings: AgreementSettings, appraisals: Mapping[str, int], period_s: float) -> None:
        """`appraisals`: name -> value (-1, 0 or +1). `period_s`: duration of a tick in s."""
        self._settings = settings
        self._values = dict(appraisals)
        self._apart_ticks = round(settings.apart_s / period_s)
        self._counted_at: int | None = None
        """Tick of the last counted signal."""
        self._signals: dict[int, deque[tuple[str, bool]]] = {
            value: deque(maxlen=settings.window) for value in (-1, 0, 1)
        }
        """Teacher's value -> (command id, whether the critic agreed)."""
        self._undone: dict[str, list[tuple[int, bool]]] = {}
        """Command id of an undone lesson -> its (teacher's value, whether the critic agreed)."""
        self._appraisal_rlas: set[int] = set()
        """Ids of all appraisal RLAs ever created."""
        self.share: float | None = None
        """Mean of the shares of agreement of each value; None while there are too few signals of value -1 or +1.

        Neutral signals are included once there are enough of them.
        """

    @property
    def trusted(self) -> bool:
        """Return whether the critic may act: it agreed with its teachers often enough."""
        return self.share is not None and self.share >= self._settings.bound

    def on_event(self, event: TeachingEvent) -> None:
        """Count a signal of an applied event, whether of the journal or new; ignore all other events."""
        match event:
            case LessonUndone(lesson, _):
                self._remove(lesson)
                return
            case LessonRedone(lesson, _):
                self._restore(lesson)
                return
            case RlaCreated(rla) if rla.level == CRITIC:
                self._appraisal_rlas.add(rla.rla_id)
        if event.origin.teacher == CRITIC:  # the critic's own events say nothing about agreement
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
        """Count the signals of teaching events of earlier runs, oldest first."""
        for event in events:
            self.on_event(event)

    def count_for(self, value: int) -> int:
        """Return the number of counted signals of a value, -1, 0 or +1."""
        return len(self._signals[value])

    def _add(self, value: int | None, event: TeachingEvent, *, right: bool) -> None:
        if value is None or self._too_soon(event.origin.tick):  # None: an appraisal of other settings
            return
        self._counted_at = event.origin.tick
        self._signals[value].append((event.origin.command_id, right))
        self._update_share()

    def _too_soon(self, tick: int) -> bool:
        """Return whether a signal is too soon after the last counted one; a lower tick belongs to a new run."""
        return self._counted_at is not None and 0 <= tick - self._counted_at < self._apart_ticks

    def _remove(self, lesson: str) -> None:
        for value, heard in self._signals.items():
            for each in [each for each in heard if each[0] == lesson]:
                heard.remove(each)
                self._undone.setdefault(lesson, []).append((value, each[1]))
        self._update_share()

    def _restore(self, lesson: str) -> None:
        """Add the signal of a redone lesson as the newest."""
        for value, right in self._undone.pop(lesson, ()):
            self._signals[value].append((lesson, right))
        self._update_share()

    def _update_share(self) -> None:
        """Compute the share once per event, because each tick reads it."""
        enough = [value for value in (-1, 0, 1) if self.count_for(value) >= self._settings.least]
        # Exact: at the bound a rounded sum decides, and Python 3.12 rounds it otherwise than Python 3.11.
        shares = [Fraction(sum(right for _, right in self._signals[value]), self.count_for(value)) for value in enough]
        self.share = float(sum(shares) / len(shares)) if {-1, 1} <= set(enough) else None
