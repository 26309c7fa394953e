"""Control of the robot: at most one page holds the lease, and its heartbeats show that the teacher is present."""


class ControlLease:
    """Lease by which one page at a time may command; the others watch, and can stop the robot.

    A page that opens gets it if it is free, or if its holder was silent for `silent_s`; `claim` takes it from any
    holder. It is not control authority: that is the robot's, and between devices. Times are seconds of a monotonic
    clock.
    """

    def __init__(self, silent_s: float = 1.0) -> None:
        """Create a free lease; a holder that is silent for `silent_s` loses it to the next page that is opened."""
        self._silent_s = silent_s
        self._renewed_s = 0.0
        self.holder: int | None = None

    def connect(self, page: int, now_s: float) -> None:
        """Give a new page the lease if it is free."""
        if self.holder is None or now_s - self._renewed_s > self._silent_s:
            self.claim(page, now_s)

    def claim(self, page: int, now_s: float) -> None:
        """Give a page the lease, from any holder."""
        self.holder = page
        self._renewed_s = now_s

    def renew(self, page: int, now_s: float) -> None:
        """Renew the lease if this page holds it."""
        if page == self.holder:
            self._renewed_s = now_s

    def hide(self, page: int) -> None:
        """Let the next page that is opened have the lease of a hidden page."""
        if page == self.holder:
            self._renewed_s = float("-inf")

    def disconnect(self, page: int) -> None:
        """Free the lease of a closed page. It is not passed on: another open page may be unattended."""
        if page == self.holder:
            self.holder = None


class OperatorPresence:
    """Presence of the teacher: the page in control is visible and shows a fresh state; heartbeats renew it."""

    def __init__(self, lease_s: float = 0.3, max_state_age_s: float = 0.5) -> None:
        """Start absent; a heartbeat holds for `lease_s`, at most until `max_state_age_s` after its state was sent."""
        self._lease_s = lease_s
        self._max_state_age_s = max_state_age_s
        self._until_s = float("-inf")

    def renew(self, state_age_s: float, now_s: float) -> None:
        """Renew the lease by a heartbeat on a state of this age."""
        self._until_s = max(self._until_s, now_s + min(self._lease_s, self._max_state_age_s - state_age_s))

    def end(self) -> None:
        """End the lease: the page is hidden, closed, or not in control any more."""
        self._until_s = float("-inf")

    def is_present(self, now_s: float) -> bool:
        """Return whether the lease holds."""
        return now_s < self._until_s
