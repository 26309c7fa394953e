"""TD(lambda): each RLA has a value V, the expected reward of the situations that it answers (paper, phase 3).

Every step, with e the trace:   delta = gamma V(now) - V(before),   V_i += alpha delta e_i
At a reward r about a tick t:   V_i += alpha r e_i(t)

V begins at `first_value`, and rewards of +1 raise it to `highest_value` at most. The two differ between supervised and
autonomous phases, which have separate values.
"""

import math
from collections.abc import Collection, Iterable, Mapping

import numpy as np

from hal.numerics import power, round_portable
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.reinforcement.settings import ReinforcementSettings, ValueSettings
from kurt2rt.core.rla.credit import Credit
from kurt2rt.core.rla.statistics import Statistics

LEAST_SHARE = 0.001
"""Least share: smaller ones have no visible effect and would fill the journal."""


EligibilityTrace = Mapping[int, float]
"""RLA id -> its share of a reward about one tick (paper, section IV.C, "temporal aspect").

A tick k ticks earlier counts (1 - d) d^k with d = exp(-1 / trace_ticks). The sum is at most 1, and less after
standstill or outside all radii. For example {17: 0.7, 4: 0.2}.
"""


def make_trace(
    recent: DecisionHistory,
    tick: int,
    *,
    trace_ticks: float,
    since: Mapping[int, int],
) -> EligibilityTrace:
    """Return the trace at a tick, from the stored decisions up to it.

    Args:
        recent: stored decisions.
        tick: rewarded tick.
        trace_ticks: time constant in ticks.
        since: RLA id -> tick in which it got its action; earlier decisions had another action and do not count.
    """
    decay = round_portable(math.exp(-1.0 / trace_ticks))
    reach = math.ceil(round_portable(-math.log(LEAST_SHARE) * trace_ticks))
    ticks, rlas = recent.answering_up_to(tick)
    for rla_id in since.keys() & set(rlas.tolist()):
        rlas[(rlas == rla_id) & (ticks < since[rla_id])] = 0
    fading = np.full(reach + 1, decay)
    fading[0] = 1.0
    fading[-1] = 0.0
    np.multiply.accumulate(fading, out=fading)  # powers by multiplication: the same on every processor
    weights = (1.0 - decay) * fading[np.minimum(tick - ticks, reach)]
    sums = np.bincount(rlas, weights)
    return {int(rla_id): float(sums[rla_id]) for rla_id in np.flatnonzero(sums >= LEAST_SHARE) if rla_id != 0}


class ValueHistory:
    """Values by RLA id, as a stack per RLA: a new action or a deletion pushes, its undo pops."""

    def __init__(self) -> None:
        self.present: dict[int, float] = {}
        """Value of each RLA's present action, if rewards changed it."""
        self._former: dict[int, list[float | None]] = {}

    def depth(self, rla_id: int) -> int:
        """Return the number of earlier actions of an RLA whose values are kept."""
        return len(self._former.get(rla_id, ()))

    def reset(self, rla_id: int) -> None:
        """Push the present value of an RLA that got another action; the new action has no value."""
        self._former.setdefault(rla_id, []).append(self.present.pop(rla_id, None))

    def restore_previous(self, rla_id: int) -> None:
        """Pop the value of an RLA's previous action and make it the present one."""
        former = self._former.get(rla_id)
        earned = former.pop() if former else None
        self.present.pop(rla_id, None)
        if earned is not None:
            self.present[rla_id] = earned

    def discard(self, rla_id: int) -> None:
        """Drop the present and all earlier values of an RLA."""
        self.present.pop(rla_id, None)
        self._former.pop(rla_id, None)

    def restore(self, saved: Mapping[int, float], only: Collection[int] | None) -> None:
        """Restore saved present values by RLA id: of all RLAs, or of `only` some."""
        if only is None:
            self.present = dict(saved)
            return
        for rla_id in only:
            self.present.pop(rla_id, None)
            if rla_id in saved:
                self.present[rla_id] = saved[rla_id]

    def get(self, rla_id: int, depth: int) -> float | None:
        """Return the value (dimensionless) of an RLA's action at a depth, 0 the first action; None without rewards."""
        former = self._former.get(rla_id, [])
        return former[depth] if depth < len(former) else self.present.get(rla_id)

    def set(self, rla_id: int, depth: int, earned: float) -> None:
        """Replace the value (dimensionless) of an RLA's action at a depth, 0 the first action."""
        former = self._former.get(rla_id, [])
        if depth < len(former):
            former[depth] = earned
        else:
            self.present[rla_id] = earned


class TdLambda:
    """Learning rule of phase 3: values of RLAs, by the formulas above this module (Sutton 1988; paper, section IV.C).

    `update` follows each tick; rewards arrive as events with credits, so that replay and undo need no formula.
    An undo subtracts the credits of its lesson only.
    """

    def __init__(self, settings: ReinforcementSettings, values: ValueSettings, period_s: float) -> None:
        """`values`: first and highest value; `period_s`: duration of a tick in s."""
        self._settings = settings
        self._value_settings = values
        self._decay = round_portable(math.exp(-period_s / settings.trace_s))
        self._step_ticks = max(1, round(settings.step_s / period_s))
        self._history = ValueHistory()
        """V minus the first value."""
        self._trace: dict[int, float] = {}
        """Trace divided by `_scale`, so that a tick changes one entry only."""
        self._scale = 1.0
        self._tick = -1
        self._before: int | None = None
        """RLA that drove in the tick of the last step."""
        self._before_tick = -1
        self._trace_before: dict[int, float] = {}
        """Trace in the tick of the last step."""

    def update(self, rla_id: int | None, tick: int) -> None:
        """Learn from one tick: decay the trace, add the answering RLA, and make a step every `step_s`.

        `rla_id`: answering RLA; None at standstill or outside its radius.
        """
        self._scale *= self._decay if tick == self._tick + 1 else power(self._decay, tick - self._tick)
        self._tick = tick
        if self._scale < 1e-100:
            self._trace, self._scale = {}, 1.0
        if rla_id is not None:
            self._trace[rla_id] = self._trace.get(rla_id, 0.0) + (1.0 - self._decay) / self._scale
        if tick % self._step_ticks == 0:
            self._step(rla_id, tick)

    def credits_for(self, value: int, trace: EligibilityTrace) -> tuple[Credit, ...]:
        """Return each RLA's share of a reward of -1 or +1, limited by the highest value; nothing is changed."""
        alpha = self._settings.alpha
        changes = ((rla_id, self._change(rla_id, alpha * value * share)) for rla_id, share in trace.items())
        return tuple(Credit(rla_id, change) for rla_id, change in changes if change != 0.0)

    def learn(self, value: int, trace: EligibilityTrace) -> None:
        """Add alpha r e_i(t) to the value V_i of each RLA of a trace; `value` is the reward r, -1 or +1."""
        for rla_id, change in self.credits_for(value, trace):
            self._add(rla_id, change)

    def apply_credits(self, updates: Iterable[tuple[Credit, int]], sign: int) -> None:
        """Add credits of the journal to values (`sign` +1), or subtract them from existing values (-1).

        `updates`: each credit with the result of `depth` when the reward was given.
        """
        for (rla_id, change), depth in updates:
            earned = self._history.get(rla_id, depth)
            if earned is not None or sign > 0:
                self._history.set(rla_id, depth, (earned or 0.0) + sign * change)

    def value(self, rla_id: int) -> float:
        """Return V of an RLA's present action, a score of about -1 to 1; more is better."""
        return self._value_settings.first_value + self._history.present.get(rla_id, 0.0)

    def depth(self, rla_id: int) -> int:
        """Return the number of earlier actions of an RLA that an undo can restore."""
        return self._history.depth(rla_id)

    def reset(self, rla_id: int) -> None:
        """Start V of an RLA that got another action at the first value, without a trace."""
        self._history.reset(rla_id)
        self._drop_trace(rla_id)

    def restore_previous(self, rla_id: int) -> None:
        """Restore V of an RLA's previous action, without a trace."""
        self._history.restore_previous(rla_id)
        self._drop_trace(rla_id)

    def archive(self, rla_id: int) -> None:
        """Keep V of a deleted RLA for an undo."""
        self._history.reset(rla_id)
        self._drop_trace(rla_id)
        self._end_step_from(rla_id)

    def discard(self, rla_id: int) -> None:
        """Drop all values of an RLA whose creation was undone."""
        self._history.discard(rla_id)
        self._drop_trace(rla_id)
        self._end_step_from(rla_id)

    @property
    def values(self) -> Mapping[int, float]:
        """V of each RLA that differs from the first value, for the checkpoint."""
        first_value = self._value_settings.first_value
        return {rla_id: first_value + change for rla_id, change in self._history.present.items()}

    def restore(self, saved: Statistics, only: Collection[int] | None = None) -> None:
        """Restore saved values of all RLAs, or of `only` some."""
        first_value = self._value_settings.first_value
        changes = {rla_id: value - first_value for rla_id, value in saved.values.items()}
        self._history.restore(changes, only)

    def _change(self, rla_id: int, change: float) -> float:
        """Return the change of V: up to the highest value; a negative change starts from there if V is above."""
        room = self._room_above(rla_id)
        return min(change, max(0.0, room)) if change > 0.0 else change + min(0.0, room)

    def _room_above(self, rla_id: int) -> float:
        """Return the distance of V to the highest value; negative if an undo of a punishment raised V above."""
        highest = self._value_settings.highest_value
        return math.inf if highest is None else highest - self.value(rla_id)

    def _add(self, rla_id: int, change: float) -> None:
        self._history.present[rla_id] = self._history.present.get(rla_id, 0.0) + change

    def _drop_trace(self, rla_id: int) -> None:
        self._trace.pop(rla_id, None)
        self._trace_before.pop(rla_id, None)

    def _end_step_from(self, rla_id: int) -> None:
        if self._before == rla_id:
            self._before = None

    def _step(self, now: int | None, tick: int) -> None:
        alpha, gamma = self._settings.alpha, self._settings.gamma
        if now is not None and self._before is not None and tick - self._before_tick == self._step_ticks:
            delta = gamma * self.value(now) - self.value(self._before)
            for rla_id, share in self._trace_before.items():
                change = alpha * delta * share
                self._add(rla_id, min(change, max(0.0, self._room_above(rla_id))))
        self._before, self._before_tick = now, tick
        faded = {rla_id: share * self._scale for rla_id, share in self._trace.items()}
        self._trace = {rla_id: share for rla_id, share in faded.items() if share >= LEAST_SHARE}
        self._scale = 1.0
        self._trace_before = dict(self._trace)
