"""Whether a robot that is alone needs its critic: one that does well is left alone."""

from kurt2rt.core.critic.settings import ActivationSettings


class ActivationMonitor:
    """A leaky mean of how much of the driven time was bad, plain at first; once it is too much, it is needed for good.

    A critic errs at times, and what it errs about is a small share of the time where nothing is wrong.
    """

    def __init__(self, settings: ActivationSettings, period_s: float) -> None:
        """`period_s` of a tick."""
        self._bad_share = settings.bad_share
        self._kept = 1.0 - min(1.0, period_s / settings.mean_s)
        self._first_ticks = round(settings.first_s / period_s)
        self.reset()

    def reset(self) -> None:
        """The robot is alone from now on."""
        self.needed = False
        """Whether the critic has to act."""
        self._bad = self._weight = 0.0
        self._ticks = 0

    @property
    def share(self) -> float:
        """Mean share of bad time; 0 before it drove."""
        return self._bad / self._weight if self._weight else 0.0

    def update(self, *, driving: bool, bad: bool) -> None:
        """Count one tick of phase 5; time in which nothing drives does not count."""
        self._ticks += 1
        if driving:
            self._bad = self._kept * self._bad + bad
            self._weight = self._kept * self._weight + 1.0
        if self._ticks >= self._first_ticks and self.share >= self._bad_share:
            self.needed = True
