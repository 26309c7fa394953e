"""Connections that have not shown the cookie: how many there may be, and which one gives way."""

from collections import OrderedDict
from collections.abc import Callable


class ConnectionLimiter:
    """Strangers at the door. Each new one may be the teacher, so it is the oldest that goes, not the newest.

    One address holds only so many places: who opens many connections pushes out his own.
    """

    def __init__(self, most: int = 32, per_address: int = 12) -> None:
        self._most = most
        self._per_address = per_address
        self._waiting: OrderedDict[object, tuple[str, Callable[[], None]]] = OrderedDict()

    def enter(self, who: object, address: str, go: Callable[[], None]) -> None:
        """A connection was opened from an address; `go` closes it. Another one may have to go for it."""
        same = [each for each, (its, _) in self._waiting.items() if its == address]
        if len(same) >= self._per_address:
            self._send_away(same[0])
        elif len(self._waiting) >= self._most:
            self._send_away(next(iter(self._waiting)))
        self._waiting[who] = (address, go)

    def leave(self, who: object) -> None:
        """It has shown the cookie, or is closed."""
        self._waiting.pop(who, None)

    def __len__(self) -> int:
        return len(self._waiting)

    def _send_away(self, who: object) -> None:
        _, go = self._waiting.pop(who)
        go()
