"""Presence of the teacher: the page in control is visible and shows a fresh state."""


class OperatorPresence:
    """Lease that heartbeats renew. Times are seconds of a monotonic clock."""

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
