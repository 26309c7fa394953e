"""When the critic speaks in its teacher's place (paper, phase 5)."""

from typing import NamedTuple

from kurt2rt.core.critic.activation import ActivationMonitor
from kurt2rt.core.critic.agreement import Agreement
from kurt2rt.core.critic.critic import Opinion
from kurt2rt.core.critic.settings import CriticSettings


class Signal(NamedTuple):
    """What the critic says of a tick, as a teacher's reward would."""

    value: int
    """-1 or +1."""
    appraisal: str
    tick: int
    """The one that is meant: that in which it was said."""
    trace_s: float
    """How far back it reaches."""


class Autonomy:
    """Makes a trusted critic's opinions signals, bad ones and good ones no more often than a person would."""

    def __init__(self, settings: CriticSettings, agreement: Agreement, period_s: float) -> None:
        """`period_s` of a tick."""
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
        """The robot is alone from now on."""
        self.activation.reset()

    def signal(self, tick: int, opinion: Opinion | None, driving: bool, *, listening: bool = False) -> Signal | None:
        """What is to be learnt from in this tick, of what the critic thinks; to be asked in every tick of phase 5.

        `driving`: whether an action drives. `listening`: it says nothing now, whatever it thinks. None where the critic
        is not trusted or not needed, has just said the same, or has not thought so for long enough: what it thinks for
        a moment is often chance.
        """
        thought = opinion.value if opinion is not None and driving and opinion.known else 0
        if thought != self._opinion_value or tick != self._last_tick + 1:
            self._opinion_value, self._since_tick = thought, tick
        self._last_tick = tick
        held = thought != 0 and tick - self._since_tick >= self._patience_ticks
        self.activation.update(driving=driving, bad=held and thought < 0)
        if opinion is None or not held or listening or not self.activation.needed:
            return None
        if tick < self._next_tick[opinion.value] or not self._agreement.trusted:
            return None
        self._next_tick[opinion.value] = tick + self._every_ticks[opinion.value]
        return Signal(opinion.value, opinion.appraisal, tick, opinion.trace_s)
