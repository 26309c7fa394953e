"""Are the infra-red readings alive? A board that hangs may repeat itself, bit for bit, in frames that look fresh."""

import math

_NAMES = {"ADC": "first", "BDC": "second"}


class Board:
    """One controller's distance channels, known by the first letters of their names (docs/the-robot.md#messages)."""

    __slots__ = ("letters", "still_s")

    def __init__(self, letters: str) -> None:
        self.letters = letters
        self.still_s = 0.0
        """For how long the robot has driven since a distance channel changed."""

    def __str__(self) -> str:
        return f"distance sensors of the {_NAMES[self.letters]} controller ({self.letters}*)"


class InfraredWatch:
    """Notices a board whose distance channels all stay the same for `frozen_infrared_s` in which the robot drives.

    Each real sensor measures about 26 times a second and flickers, also with nothing in view: eight of them do not
    repeat themselves for a second (docs/the-robot.md#noise-and-timing). A robot that stands may have a board that
    hangs; but only a reading that changes shows that it lives, so that neither a stop in between nor a resume makes it
    good for another second.
    """

    def __init__(self, channels: tuple[str, ...], frozen_infrared_s: float) -> None:
        """`channels`: ADC00 and so on, those with a distance sensor."""
        self._frozen_s = frozen_infrared_s
        self._looked_at_s = math.inf
        self._boards = {letters: Board(letters) for letters in sorted({channel[:3] for channel in channels})}

    def board_of(self, channel: str) -> Board:
        """The board that a channel with a distance sensor belongs to; who reads it notes there that it changed."""
        return self._boards[channel[:3]]

    def check_frozen(self, now_s: float, *, driving: bool) -> str:
        """Which board is frozen, in a line; empty while all are alive."""
        looked_at_s, self._looked_at_s = self._looked_at_s, now_s
        if not driving:
            return ""
        for board in self._boards.values():
            board.still_s += max(0.0, now_s - looked_at_s)
        for board in self._boards.values():
            if board.still_s >= self._frozen_s:
                return f"the {board} repeated themselves for {self._frozen_s:g} s; switch the robot off and on"
        return ""
