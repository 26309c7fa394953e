"""Deadman switch of one page: the robot drives by hand only while presses arrive in time."""


class DeadmanSwitch:
    """State of the press that drives. A press ends by release or silence, and never starts again.

    TCP may deliver late messages in a burst, so a message counts by the age of the state that the page showed, not by
    its arrival. Times are seconds of a monotonic clock.
    """

    def __init__(self, lease_s: float = 0.25, max_state_age_s: float = 0.4) -> None:
        """Start open; a message holds for `lease_s`, at most until `max_state_age_s` after its state was sent."""
        self._lease_s = lease_s
        self._max_state_age_s = max_state_age_s
        self._press_id: int | None = None
        self._ended = 0
        self._until_s = 0.0

    @property
    def held(self) -> bool:
        """True while a press drives."""
        return self._press_id is not None

    def is_held_by(self, press_id: int) -> bool:
        """Return whether this press drives."""
        return self._press_id == press_id

    def press(self, press_id: int, state_age_s: float, now_s: float) -> bool:
        """Begin or renew a press at `now_s`; return False if the message does not count. Press ids grow.

        A message does not count on a state older than the limit (`state_age_s`, in s), or for a press that ended.
        """
        if press_id <= self._ended or state_age_s >= self._max_state_age_s:
            return False
        if self._press_id != press_id:
            # A larger id ends all presses before it.
            self._ended = press_id - 1
            self._press_id = press_id
            self._until_s = now_s
        self._until_s = max(self._until_s, now_s + min(self._lease_s, self._max_state_age_s - state_age_s))
        return True

    def release(self) -> None:
        """End the press."""
        if self._press_id is not None:
            self._ended = self._press_id
            self._press_id = None

    def expired(self, now_s: float) -> bool:
        """Return whether the press that drives was not renewed in time."""
        return self._press_id is not None and now_s >= self._until_s
