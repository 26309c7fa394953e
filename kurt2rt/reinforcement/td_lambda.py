"""TD(lambda): each RLA has a value V, what may be expected of a situation that it answers (paper, phase 3).

Every step, with e the trace:   delta = gamma V(now) - V(before),   V_i += alpha delta e_i
At a signal r about a tick t:   V_i += alpha r e_i(t)

V begins at `first_value` and never rises above `highest_value`.
"""

import math
from collections.abc import Iterable, Mapping

from kurt2rt.knowledge.statistics import Statistics
from kurt2rt.reinforcement.accounts import Accounts
from kurt2rt.reinforcement.rule import Booking
from kurt2rt.reinforcement.settings import ReinforcementSettings
from kurt2rt.reinforcement.trace import LEAST_SHARE, Trace
from kurt2rt.rla.rla import Credit


class TdLambda:
    """Values of RLAs, and an eligibility trace of those that drive."""

    def __init__(self, settings: ReinforcementSettings, period_s: float) -> None:
        """`period_s` of a tick."""
        self._settings = settings
        self._decay = math.exp(-period_s / settings.trace_s)
        self._step_ticks = max(1, round(settings.step_s / period_s))
        self._accounts = Accounts[float]()
        self._trace: dict[int, float] = {}
        """Divided by the scale, so that a tick need not touch what only fades."""
        self._scale = 1.0
        self._tick = -1
        self._before: int | None = None
        """Which RLA drove in the tick of the last step."""
        self._before_tick = -1
        self._trace_before: dict[int, float] = {}
        """The trace as it was in the tick of the last step."""

    def drove(self, rla_id: int | None, tick: int) -> None:
        """Take in one tick: the trace fades, grows for the one that answered, and every so often a step is made."""
        self._scale *= self._decay if tick == self._tick + 1 else self._decay ** (tick - self._tick)
        self._tick = tick
        if self._scale < 1e-100:
            self._trace, self._scale = {}, 1.0
        if rla_id is not None:
            self._trace[rla_id] = self._trace.get(rla_id, 0.0) + (1.0 - self._decay) / self._scale
        if tick % self._step_ticks == 0:
            self._step(rla_id, tick)

    def credits_of(self, value: int, trace: Trace) -> tuple[Credit, ...]:
        """Each RLA its share of the signal, as far as its value may rise."""
        alpha = self._settings.alpha
        changes = ((rla_id, self._change(rla_id, alpha * value * share)) for rla_id, share in trace.shares.items())
        return tuple(Credit(rla_id, change) for rla_id, change in changes if change != 0.0)

    def take(self, value: int, trace: Trace) -> None:
        """V_i += alpha r e_i(t)."""
        for rla_id, change in self.credits_of(value, trace):
            self._accounts.present[rla_id] = self.worth(rla_id) + change

    def book(self, bookings: Iterable[Booking], sign: int) -> None:
        """Add credits to values, or take them off."""
        for (rla_id, change), depth in bookings:
            earned = self._accounts.at(rla_id, depth)
            value = self._settings.first_value if earned is None else earned
            self._accounts.put(rla_id, depth, value + sign * change)

    def worth(self, rla_id: int) -> float:
        """V."""
        return self._accounts.present.get(rla_id, self._settings.first_value)

    def depth(self, rla_id: int) -> int:
        """How many actions it has had before."""
        return self._accounts.depth(rla_id)

    def renew(self, rla_id: int) -> None:
        """V of the new action is that of the beginning, and what the old one did is not its merit."""
        self._accounts.renew(rla_id)
        self._trace.pop(rla_id, None)
        self._trace_before.pop(rla_id, None)

    def go_back(self, rla_id: int) -> None:
        """V as it was."""
        self._accounts.go_back(rla_id)
        self._trace.pop(rla_id, None)
        self._trace_before.pop(rla_id, None)

    @property
    def values(self) -> Mapping[int, float]:
        """V where it is not that of the beginning."""
        return self._accounts.present

    @property
    def edge_weights(self) -> Mapping[tuple[int, int], float]:
        """None."""
        return {}

    def restore(self, saved: Statistics) -> None:
        """Values as they were saved."""
        self._accounts.present = dict(saved.values)

    def _change(self, rla_id: int, change: float) -> float:
        """What is left of a change below the highest value; an undone blame may have lifted V above it."""
        return min(change, max(0.0, self._settings.highest_value - self.worth(rla_id)))

    def _step(self, now: int | None, tick: int) -> None:
        alpha, gamma = self._settings.alpha, self._settings.gamma
        if now is not None and self._before is not None and tick - self._before_tick == self._step_ticks:
            delta = gamma * self.worth(now) - self.worth(self._before)
            for rla_id, share in self._trace_before.items():
                self._accounts.present[rla_id] = self.worth(rla_id) + self._change(rla_id, alpha * delta * share)
        self._before, self._before_tick = now, tick
        faded = {rla_id: share * self._scale for rla_id, share in self._trace.items()}
        self._trace = {rla_id: share for rla_id, share in faded.items() if share >= LEAST_SHARE}
        self._scale = 1.0
        self._trace_before = dict(self._trace)
