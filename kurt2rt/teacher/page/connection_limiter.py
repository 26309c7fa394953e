"""Limit on unauthenticated connections. The oldest is closed, because a new one may be the teacher's."""

from collections import OrderedDict
from collections.abc import Callable


class ConnectionLimiter:
    """Open connections without a cookie, at most `most`, and `per_address` of one address."""

    def __init__(self, most: int = 32, per_address: int = 12) -> None:
        self._most = most
        self._per_address = per_address
        self._waiting: OrderedDict[object, tuple[str, Callable[[], None]]] = OrderedDict()

    def add(self, connection: object, address: str, close: Callable[[], None]) -> None:
        """Add a connection of an address, and close the oldest one (of that address) if there are too many."""
        same = [each for each, (its, _) in self._waiting.items() if its == address]
        if len(same) >= self._per_address:
            self._evict(same[0])
        elif len(self._waiting) >= self._most:
            self._evict(next(iter(self._waiting)))
        self._waiting[connection] = (address, close)

    def remove(self, connection: object) -> None:
        """Stop counting a connection: it has shown the cookie, or was closed."""
        self._waiting.pop(connection, None)

    def __len__(self) -> int:
        return len(self._waiting)

    def _evict(self, connection: object) -> None:
        _, close = self._waiting.pop(connection)
        close()
