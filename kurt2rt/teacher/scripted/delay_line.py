"""Delay line: items come out a fixed number of ticks after they went in."""

from collections import deque
from typing import Generic, TypeVar

_Item = TypeVar("_Item")


class DelayLine(Generic[_Item]):
    """First-in, first-out queue with a delay."""

    def __init__(self, delay_ticks: int) -> None:
        """Delay each item by `delay_ticks`."""
        self._delay_ticks = delay_ticks
        self._items: deque[tuple[int, _Item]] = deque()

    def put(self, now: int, item: _Item) -> None:
        """Add an item in tick `now`."""
        self._items.append((now + self._delay_ticks, item))

    def pop(self, now: int) -> _Item | None:
        """Return the oldest item whose delay is over in tick `now`; None if there is none."""
        if not self._items or self._items[0][0] > now:
            return None
        return self._items.popleft()[1]

    @property
    def next_due(self) -> int | None:
        """Tick in which the oldest item comes out; None without items."""
        return self._items[0][0] if self._items else None

    def clear(self) -> None:
        """Drop all items that are still on their way."""
        self._items.clear()
