"""Watches a drive along a route, and says of each wrong decision which layer failed."""

from collections import deque
from typing import Literal

from behaviors.metrics.junctions import QUARTERS
from behaviors.metrics.route import FixedRoute, Passage
from behaviors.metrics.task_metric import TaskMetric
from config.settings import Settings
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.tick_record import TickRecord

Layer = Literal["symbols", "mid", "basic"]
"""Layer that failed: `symbols`, noticed junctions differ from the real ones; `mid`, a wrong choice from right symbols;
`basic`, a right choice that was not driven."""
LAYERS: tuple[Layer, ...] = ("symbols", "mid", "basic")
_HISTORY = 12
"""So many junctions back what was noticed is compared with what was; older ones are in no history (VI.B.2)."""


class RouteMistake(Settings):
    """Junction of a route that the robot left wrong, with the layer of the robot that is the cause."""

    at_s: float
    leg: int
    """Index of the junction on the route, from 0."""
    layer: Layer
    x_m: float
    y_m: float


class RouteMonitor:
    """Finder of the layer that failed at each junction left wrong: noticing, the mid level, or driving.

    It compares the junctions that the robot noticed with those that it really drove through.
    """

    def __init__(self) -> None:
        self.wrong: list[RouteMistake] = []
        self._judged = 0
        self._noticed: deque[int] = deque(maxlen=_HISTORY)
        self._true: deque[int] = deque(maxlen=_HISTORY)
        self._inside = False
        self._wanted = ""
        """Behaviour that was active at the entry of the newest junction."""
        self._changed = ""
        """Other behaviour that became active within that junction; empty if none did."""
        self._knew = True
        """True if at that entry the robot had noticed exactly the turns that it had made."""
        self._last: tuple[TickRecord, FixedRoute] | None = None

    def on_tick(self, record: TickRecord, metric: TaskMetric) -> None:
        """Compare one tick: note junctions that the robot noticed or entered, and judge each that it left.

        Call it on every tick, after the metric `metric`, a FixedRoute, was updated. Errors are appended to `wrong`.
        """
        assert isinstance(metric, FixedRoute)
        self._last = record, metric
        mid = record.decision.mid
        if mid is not None and mid.event is not None:
            self._noticed.append(mid.event.quarters)
        inside = metric.ahead.inside
        if inside and not self._inside:
            self._wanted, self._changed = record.behaviour, ""
            self._knew = self._knows()
        elif inside and record.behaviour != self._wanted:
            self._changed = record.behaviour
        self._inside = inside
        self._judge()

    def end(self) -> None:
        """Judge the last junctions; call it once, after the drive."""
        self._judge()

    def _judge(self) -> None:
        if self._last is None:
            return
        record, metric = self._last
        for passage in metric.passages[self._judged :]:
            self._judged += 1
            if passage.taken != passage.right:
                layer = self._who_failed(passage, record)
                self.wrong.append(
                    RouteMistake(
                        at_s=round(record.now_s, 2),
                        leg=passage.leg,
                        layer=layer,
                        x_m=round(passage.x_m, 3),
                        y_m=round(passage.y_m, 3),
                    )
                )
            if passage.taken is not None:
                self._true.append(passage.taken)

    def _who_failed(self, passage: Passage, record: TickRecord) -> Layer:
        mid = record.decision.mid
        if mid is None:
            return "basic"
        if record.decision.asking and record.decision.asks_at == MID:
            return "mid" if self._knows() else "symbols"
        wanted, knew = self._wanted, self._knew
        if passage.taken is None and not self._inside:  # it did not come to that junction
            if self._is_to_notice():
                return "basic"  # it got stuck, or turned back, just behind the one before
            wanted, knew = record.behaviour, self._knows()
        if QUARTERS[wanted] != passage.right:
            return "mid" if knew else "symbols"
        # It was told what is right there; what it was told on the way through may be about the next one already.
        misled = self._changed and passage.taken == QUARTERS[self._changed]
        return "symbols" if misled else "basic"

    def _knows(self) -> bool:
        """Return whether the noticed turns are the real ones."""
        return tuple(self._noticed) == tuple(self._true)

    def _is_to_notice(self) -> bool:
        """Return whether only the last junction is not noticed yet."""
        recent = _HISTORY - 1
        return tuple(self._noticed)[-recent:] == tuple(self._true)[:-1] and bool(self._true)
