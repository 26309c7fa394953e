"""Are the infra-red readings alive? A board that hangs may repeat itself, bit for bit, in frames that look fresh."""

_NAMES = {"ADC": "first", "BDC": "second"}


class Board:
    """One controller's distance channels, known by the first letters of their names (reference 1.2)."""

    __slots__ = ("alive_at_s", "letters")

    def __init__(self, letters: str) -> None:
        self.letters = letters
        self.alive_at_s = 0.0
        """When a distance channel last changed, or the robot last stood."""

    def __str__(self) -> str:
        return f"distance sensors of the {_NAMES[self.letters]} controller ({self.letters}*)"


class InfraredWatch:
    """Notices a board whose distance channels all stay the same for `frozen_infrared_s` while the robot drives.

    Each real sensor measures about 26 times a second and flickers, also with nothing in view (reference 3.3): eight of
    them do not repeat themselves for a second. A robot that stands may have a board that hangs.
    """

    def __init__(self, channels: tuple[str, ...], frozen_infrared_s: float) -> None:
        """`channels`: ADC00 and so on, those with a distance sensor."""
        self._frozen_s = frozen_infrared_s
        self._boards = {letters: Board(letters) for letters in sorted({channel[:3] for channel in channels})}

    def board_of(self, channel: str) -> Board:
        """The board that a channel with a distance sensor belongs to; who reads it notes there when it changed."""
        return self._boards[channel[:3]]

    def freeze(self, now_s: float, *, driving: bool) -> str:
        """Which board is frozen, in a line; empty while all are alive."""
        for board in self._boards.values():
            if not driving:
                board.alive_at_s = now_s
            elif now_s - board.alive_at_s >= self._frozen_s:
                return f"the {board} repeated themselves for {self._frozen_s:g} s; switch the robot off and on"
        return ""
