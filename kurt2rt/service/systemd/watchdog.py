"""The pings that keep the service manager from starting the program anew: each the outcome of a look at the program."""

from collections.abc import Callable, Mapping

from kurt2rt.service.systemd.notifier import Notifier

LATE_SHARE = 0.5
"""Of the ticks since the last ping; when more of them were missed the program is not well."""


class WatchdogNotifier:
    """Pings at half the manager's interval, from inside the tick, while ticks come in time and all parts are alive.

    There is no timer: a loop that hangs sends nothing.
    """

    def __init__(
        self,
        notifier: Notifier,
        period_s: float,
        parts: Mapping[str, Callable[[], bool]],
        tell: Callable[[str], None] = lambda _: None,
    ) -> None:
        """`period_s`: between two ticks. `parts`: what else has to be alive, by name for whoever reads the status.

        `tell` takes what is wrong, for the log; it may not wait.
        """
        self._notifier = notifier
        self._period_s = period_s
        self._liveness = parts
        self._log = tell
        self._pings_every_s = None if notifier.watchdog_s is None else notifier.watchdog_s / 2
        self._ticks = 0
        self._since_s: float | None = None
        self.trouble = ""
        """Why no pings are sent at present, in a line; empty while they are."""

    def on_tick(self, now_s: float) -> None:
        """A tick is done, at `now_s` of any clock that does not jump."""
        if self._pings_every_s is None:
            return
        self._ticks += 1
        if self._since_s is None:  # the first tick says that the program has begun
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
            return f"{', '.join(dead)} ended; the service manager starts the program anew"
        due = passed_s / self._period_s
        if self._ticks < (1 - LATE_SHARE) * due:
            return f"{self._ticks} of {due:.0f} ticks came in time"
        return ""
