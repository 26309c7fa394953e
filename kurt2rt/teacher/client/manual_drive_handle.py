"""One press of the hand at the wheels, as `TeacherClient.driving` gives it."""

from kurt2rt.teacher.client.manual_drive import ManualDrive


class ManualDriveHandle:
    """Set speeds as often as you like; they go out 50 times a second. Once the press has ended it stays ended."""

    def __init__(self, hand: ManualDrive) -> None:
        self._hand = hand
        self._hold: int | None = None

    @property
    def hold(self) -> int | None:
        """Number of its press; None before it begins."""
        return self._hold

    @property
    def ended(self) -> str:
        """Why the press ended by itself, in a sentence; empty while it is on, or not begun."""
        if self._hold is None or self._hand.hold == self._hold:
            return ""
        refusal = self._hand.refusal
        return "let go" if refusal is None else refusal.text or refusal.why

    def set(self, left_m_s: float, right_m_s: float) -> bool:
        """New speeds; whether the press is on. Raises WireError for speeds that no robot takes."""
        # Not begun anew behind the driver's back: after a pause nobody knows whether he still means it.
        if self._hold is not None and self._hand.hold != self._hold:
            return False
        pressing = self._hand.press(left_m_s, right_m_s)
        if self._hold is None:
            self._hold = self._hand.hold
        return pressing
