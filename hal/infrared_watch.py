"""Detection of frozen infra-red readings: a board that hangs may repeat them bit for bit in fresh frames."""

import math

_NAMES = {"ADC": "first", "BDC": "second"}


class Board:
    """Distance channels of one controller, by the first letters of their names (docs/the-robot.md#messages)."""

    __slots__ = ("letters", "still_s")

    def __init__(self, letters: str) -> None:
        self.letters = letters
        self.still_s = 0.0
        """Time in s that the robot has driven since a distance channel changed."""

    def __str__(self) -> str:
        return f"distance sensors of the {_NAMES[self.letters]} controller ({self.letters}*)"


class InfraredWatch:
    """Detector of a board whose distance channels all stay the same for `frozen_infrared_s` while the robot drives.

    Each real sensor measures about 26 times a second and flickers, also with nothing in view: eight of them do not
    repeat themselves for a second (docs/the-robot.md#noise-and-timing). A robot that stands may have a board that
    hangs. Only a changed reading shows that the board works: neither a stop nor a resume clears the time.
    """

    def __init__(self, channels: tuple[str, ...], frozen_infrared_s: float) -> None:
        """Watch `channels`, such as ADC00, that have a distance sensor."""
        self._frozen_s = frozen_infrared_s
        self._looked_at_s = math.inf
        self._boards = {letters: Board(letters) for letters in sorted({channel[:3] for channel in channels})}

    def board_of(self, channel: str) -> Board:
        """Return the board of a channel, such as ADC00. Raises KeyError for a board without sensors.

        The reader of the channel sets `still_s` of the board to 0 after a change.
        """
        return self._boards[channel[:3]]

    def check_frozen(self, now_s: float, *, driving: bool) -> str:
        """Return one line about a frozen board; empty while all boards work. Call it in each tick.

        `now_s`: time of the tick in s. `driving`: whether the wheels are told to turn.
        """
        looked_at_s, self._looked_at_s = self._looked_at_s, now_s
        if not driving:
            return ""
        elapsed_s = max(0.0, now_s - looked_at_s)
        for board in self._boards.values():
            board.still_s += elapsed_s
        for board in self._boards.values():
            if board.still_s >= self._frozen_s:
                return f"the {board} repeated themselves for {self._frozen_s:g} s; switch the robot off and on"
        return ""
