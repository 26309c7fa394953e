"""Detection of frozen infra-red readings: a board that hangs may repeat them bit for bit in fresh frames."""

import math
from collections.abc import Iterable


class Board:
    """Converter board that samples some of the distance sensors; a frozen one stops the robot."""

    __slots__ = ("name", "still_s")

    def __init__(self, name: str) -> None:
        self.name = name
        self.still_s = 0.0
        """Time in s that the robot has driven since one of its readings changed."""


class InfraredWatch:
    """Detector of a board whose readings all stay the same for `frozen_infrared_s` while the robot drives.

    Each real sensor measures about 26 times a second and flickers, also with nothing in view: eight of them do not
    repeat themselves for a second (docs/the-robot.md#noise-and-timing). A robot that stands may have a board that
    hangs. Only a changed reading shows that the board works: neither a stop nor a resume clears the time.
    """

    def __init__(self, boards: Iterable[str], frozen_infrared_s: float) -> None:
        """Watch the boards of these names, each of which reads a distance sensor."""
        self._frozen_s = frozen_infrared_s
        self._looked_at_s = math.inf
        self._boards = {name: Board(name) for name in sorted(set(boards))}

    def board(self, name: str) -> Board:
        """Return the board of a name. Raises KeyError for one that is not watched.

        The reader of its sensors sets `still_s` of the board to 0 after a change.
        """
        return self._boards[name]

    def check_frozen(self, now_s: float, *, driving: bool) -> str:
        """Return one line about a frozen board; empty while all boards work. Call it in each tick.

        `now_s`: time of the tick in s. `driving`: whether the set points turn the wheels.
        """
        looked_at_s, self._looked_at_s = self._looked_at_s, now_s
        if not driving:
            return ""
        elapsed_s = max(0.0, now_s - looked_at_s)
        for board in self._boards.values():
            board.still_s += elapsed_s
        for board in self._boards.values():
            if board.still_s >= self._frozen_s:
                sensors = f"the distance sensors of the {board.name}"
                return f"{sensors} repeated themselves for {self._frozen_s:g} s; switch the robot off and on"
        return ""
