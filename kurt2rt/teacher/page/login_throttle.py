"""Limit on wrong tokens of an address. The right token is never limited."""

from collections import OrderedDict


class LoginThrottle:
    """A bucket of tries per address that fills up again. Times are seconds of any clock that only grows."""

    def __init__(self, most: int = 5, per_s: float = 0.2, addresses: int = 256) -> None:
        """`most` tries at once, then `per_s`; only the last `addresses` are remembered, so a flood costs no memory."""
        self._most = most
        self._per_s = per_s
        self._addresses = addresses
        self._left: OrderedDict[str, tuple[float, float]] = OrderedDict()

    def allowed(self, address: str, now_s: float) -> bool:
        """Whether this address may try now; does not count as a try."""
        return self._at(address, now_s) >= 1.0

    def failed(self, address: str, now_s: float) -> None:
        """A try went wrong."""
        self._left[address] = (self._at(address, now_s) - 1.0, now_s)
        self._left.move_to_end(address)
        if len(self._left) > self._addresses:
            self._left.popitem(last=False)

    def _at(self, address: str, now_s: float) -> float:
        left, when_s = self._left.get(address, (float(self._most), now_s))
        return min(float(self._most), left + (now_s - when_s) * self._per_s)
