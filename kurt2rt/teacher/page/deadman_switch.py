"""Hold-to-drive as the page's server sees it."""


class DeadmanSwitch:
    """One press after another; each ends with a release or with silence, and what ended never begins again.

    TCP hands over late heartbeats in a burst, so a press counts by the age of the picture it was given on, not by its
    arrival alone. Times are seconds of any clock that only grows.
    """

    def __init__(self, lease_s: float = 0.25, oldest_picture_s: float = 0.4) -> None:
        """A press is good for `lease_s`, and never longer than `oldest_picture_s` after its picture was sent."""
        self._lease_s = lease_s
        self._oldest_picture_s = oldest_picture_s
        self._hold: int | None = None
        self._ended = 0
        self._until_s = 0.0

    @property
    def held(self) -> bool:
        """Whether a press is on."""
        return self._hold is not None

    def is_on(self, hold: int) -> bool:
        """Whether it is this press that is on."""
        return self._hold == hold

    def press(self, hold: int, picture_age_s: float, now_s: float) -> bool:
        """Begin or renew press number `hold` (they grow); False when it does not count."""
        if hold <= self._ended or picture_age_s >= self._oldest_picture_s:
            return False
        if self._hold != hold:
            # A larger number than that of the press that is on, which has ended by it; smaller ones ended before.
            self._ended = hold - 1
            self._hold = hold
            self._until_s = now_s
        self._until_s = max(self._until_s, now_s + min(self._lease_s, self._oldest_picture_s - picture_age_s))
        return True

    def release(self) -> None:
        """The press that is on is over for good."""
        if self._hold is not None:
            self._ended = self._hold
            self._hold = None

    def expired(self, now_s: float) -> bool:
        """Whether a press is on that nothing was heard of for too long."""
        return self._hold is not None and now_s >= self._until_s
