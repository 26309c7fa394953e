"""Progress of teaching: the share that the robot drives by itself, and its questions, over the last minute."""

from kurt2rt.core.decision.decision import StandReason
from kurt2rt.core.progress import WINDOW_S, Progress
from kurt2rt.core.tick_record import TickRecord


class ProgressMeter:
    """Counters of the last 60 seconds in a ring of one-second bins; memory and time per tick are constant."""

    def __init__(self, period_s: float) -> None:
        """`period_s`: length of a tick in s."""
        self._ticks_per_s = max(1, round(1 / period_s))
        self._ticks = [0] * WINDOW_S
        self._driven = [0] * WINDOW_S
        self._asks = [0] * WINDOW_S
        self._second = -1
        """Second of the newest bin; -1 before the first tick."""
        self._seconds = 0

    def update(self, record: TickRecord) -> None:
        """Count one tick. Missed ticks pass as time and are not counted."""
        self._turn_to(record.tick // self._ticks_per_s)
        place = self._second % WINDOW_S
        self._ticks[place] += 1
        if record.decision.rla_id is not None and record.standing.reason is StandReason.DRIVES:
            self._driven[place] += 1
        self._asks[place] += record.question_begins

    def progress(self) -> Progress:
        """Return the sums over the last minute."""
        ticks = sum(self._ticks)
        percent = 100 * sum(self._driven) // ticks if ticks else None
        return Progress(self._seconds, percent, sum(self._asks))

    def _turn_to(self, second: int) -> None:
        """Clear the bins of seconds that began after the last tick."""
        if second == self._second:
            return
        passed = 1 if self._second < 0 else min(second - self._second, WINDOW_S)
        for each in range(second - passed + 1, second + 1):
            place = each % WINDOW_S
            self._ticks[place] = self._driven[place] = self._asks[place] = 0
        self._seconds = min(self._seconds + passed, WINDOW_S)
        self._second = second
