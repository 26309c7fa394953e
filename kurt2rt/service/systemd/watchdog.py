"""Pings that keep the service manager from restarting the program, sent only while the program is well."""

from collections.abc import Callable, Mapping

from kurt2rt.service.systemd.notifier import Notifier

LATE_SHARE = 0.5
"""Fraction of missed ticks since the last ping above which the program is not well."""


class WatchdogNotifier:
    """Sender of pings at half the manager's interval, while ticks come in time and all parts are alive.

    There is no timer: a loop that hangs sends nothing.
    """

    def __init__(
        self,
        notifier: Notifier,
        period_s: float,
        liveness: Mapping[str, Callable[[], bool]],
        log: Callable[[str], None] = lambda _: None,
    ) -> None:
        """Send nothing yet.

        Args:
            notifier: connection to the manager.
            period_s: period of the ticks in s.
            liveness: checks of what must be alive, by the name for the status.
            log: gets what is wrong; may not wait.
        """
        self._notifier = notifier
        self._period_s = period_s
        self._liveness = liveness
        self._log = log
        self._pings_every_s = None if notifier.watchdog_s is None else notifier.watchdog_s / 2
        self._ticks = 0
        self._since_s: float | None = None
        self.trouble = ""
        """Reason why no pings are sent, in a line; empty while they are sent."""

    def on_tick(self, now_s: float) -> None:
        """Count a tick at `now_s` of a monotonic clock, and ping if it is time."""
        if self._pings_every_s is None:
            return
        self._ticks += 1
        if self._since_s is None:  # the first tick shows that the program has begun
            self._since_s, self._ticks = now_s, 0
            self._notifier.ping()
        elif now_s - self._since_s >= self._pings_every_s:
            self.trouble = self._trouble(now_s - self._since_s)
            self._since_s, self._ticks = now_s, 0
            if self.trouble:
                self._notifier.status(f"not well: {self.trouble}")
                self._log(f"not well: {self.trouble}")
            else:
                self._notifier.ping()

    def _trouble(self, passed_s: float) -> str:
        dead = [name for name, is_alive in self._liveness.items() if not is_alive()]
        if dead:
            return f"{', '.join(dead)} ended; the service manager starts the program again"
        due = passed_s / self._period_s
        if self._ticks < (1 - LATE_SHARE) * due:
            return f"{self._ticks} of {due:.0f} ticks came in time"
        return ""
