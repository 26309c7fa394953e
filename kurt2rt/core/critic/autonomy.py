"""Autonomy: the critic's signals instead of a teacher's rewards (paper, phase 5)."""

from kurt2rt.core.critic.agreement import Agreement
from kurt2rt.core.critic.critic import Opinion
from kurt2rt.core.critic.settings import ActivationSettings, CriticSettings


class ActivationMonitor:
    """Leaky mean of the share of bad driven time; at a threshold it activates the critic for the rest of phase 5.

    A critic errs at times: on a robot that drives well its errors are a small share of the time.
    """

    def __init__(self, settings: ActivationSettings, period_s: float) -> None:
        """`period_s`: duration of a tick in s."""
        self._bad_share = settings.bad_share
        self._kept = 1.0 - min(1.0, period_s / settings.mean_s)
        self._first_ticks = round(settings.first_s / period_s)
        self.reset()

    def reset(self) -> None:
        """Start phase 5: set the mean to 0, so that the critic is not active yet."""
        self.needed = False
        """Return whether the critic has to act."""
        self._bad = self._weight = 0.0
        self._ticks = 0

    @property
    def share(self) -> float:
        """Mean share of bad driven time, 0 to 1; 0 before the first drive."""
        return self._bad / self._weight if self._weight else 0.0

    def update(self, *, driving: bool, bad: bool) -> None:
        """Count one tick of phase 5; only driving ticks change the mean. `bad`: whether the critic finds it bad."""
        self._ticks += 1
        if driving:
            self._bad = self._kept * self._bad + bad
            self._weight = self._kept * self._weight + 1.0
        if self._ticks >= self._first_ticks and self.share >= self._bad_share:
            self.needed = True


class Autonomy:
    """Source of rewards in phase 5: opinions of a trusted and needed critic, at most as often as a person presses."""

    def __init__(self, settings: CriticSettings, agreement: Agreement, period_s: float) -> None:
        """`period_s`: duration of a tick in s."""
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
        """Start phase 5: the critic is needed only after enough bad driving in this phase."""
        self.activation.reset()

    def speaks(self, tick: int, opinion: Opinion | None, driving: bool, *, listening: bool = False) -> bool:
        """Return whether the opinion of this tick is a signal, like a reward; call it in each tick of phase 5.

        False if the critic is not trusted or not needed, if its opinion is not `patience_s` old (momentary opinions are
        often chance), or if the last signal of this value is too recent.

        Args:
            tick: number of this tick.
            opinion: critic's opinion of this tick; None before its first lesson.
            driving: whether an action drives.
            listening: whether to suppress signals.
        """
        value = opinion.value if opinion is not None and driving and opinion.known else 0
        if value != self._opinion_value or tick != self._last_tick + 1:
            self._opinion_value, self._since_tick = value, tick
        self._last_tick = tick
        held = value != 0 and tick - self._since_tick >= self._patience_ticks
        self.activation.update(driving=driving, bad=held and value < 0)
        if not held or listening or not self.activation.needed:
            return False
        if tick < self._next_tick[value] or not self._agreement.trusted:
            return False
        self._next_tick[value] = tick + self._every_ticks[value]
        return True
