"""Limit on wrong tokens of an address. The right token is never limited."""

from collections import OrderedDict


class LoginThrottle:
    """Token bucket of tries per address. Times are seconds of a monotonic clock."""

    def __init__(self, most: int = 5, per_s: float = 0.2, addresses: int = 256) -> None:
        """Allow `most` tries at once, then `per_s`; store only the last `addresses`, which bounds the memory."""
        self._most = most
        self._per_s = per_s
        self._addresses = addresses
        self._left: OrderedDict[str, tuple[float, float]] = OrderedDict()

    def is_allowed(self, address: str, now_s: float) -> bool:
        """Return whether an address may try now; this does not count as a try."""
        return self._tries_left(address, now_s) >= 1.0

    def on_failure(self, address: str, now_s: float) -> None:
        """Count a wrong token."""
        self._left[address] = (self._tries_left(address, now_s) - 1.0, now_s)
        self._left.move_to_end(address)
        if len(self._left) > self._addresses:
            self._left.popitem(last=False)

    def _tries_left(self, address: str, now_s: float) -> float:
        left, counted_s = self._left.get(address, (float(self._most), now_s))
        return min(float(self._most), left + (now_s - counted_s) * self._per_s)
