"""Filter in front of aiocoap: it drops a flood in microseconds and keeps nothing of it in memory.

A sender can forge its address and copy a key id, so neither gets it work done:

- An OSCORE request is dropped if no key has its key id, or if that key did not make its tag. Checking a tag costs some
  20 µs and has a rate of its own.
- A request with the highest sequence number of its key is no copy. It has the key's rate, from any address. So
  strangers who flood do not keep out a device that has just opened its socket.
- Any other datagram has the rate of its address if a key holder proved that address, otherwise the strangers' rate:
  requests without OSCORE, pings, confirmations of pictures, and requests that were sent again, overtaken or copied.
"""

import time
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from kurt2rt.channel.server.sealed_request import SealedRequest


class TokenBucket:
    """Rate limit: `capacity` events at once, and `rate_per_s` events a second after that."""

    __slots__ = ("_capacity", "_now", "_rate_per_s", "_since_s", "_tokens")

    def __init__(self, capacity: float, rate_per_s: float, now: Callable[[], float] = time.monotonic) -> None:
        """`now` is a clock in seconds."""
        self._capacity = capacity
        self._rate_per_s = rate_per_s
        self._now = now
        self._tokens = capacity
        self._since_s = now()

    def acquire(self) -> bool:
        """Remove a token if there is one; return whether there was one. It never waits."""
        now_s = self._now()
        self._tokens = min(self._capacity, self._tokens + (now_s - self._since_s) * self._rate_per_s)
        self._since_s = now_s
        if self._tokens < 1:
            return False
        self._tokens -= 1
        return True


class PerDeviceRateLimit:
    """Limit for each device: `most` requests at once, and one more every `every_ticks` ticks."""

    def __init__(self, most: int, every_ticks: int) -> None:
        self._most = most
        self._every_ticks = every_ticks
        self._full_at: dict[str, int] = {}
        """Tick at which a device has its full allowance again."""

    def acquire(self, device: str, tick: int) -> bool:
        """Count a request of a device; return whether it is within the limit."""
        full_at = max(self._full_at.get(device, tick), tick) + self._every_ticks
        if full_at > tick + self._most * self._every_ticks:
            return False
        self._full_at[device] = full_at
        return True


LONGEST_DATAGRAM = 1500
"""Longest datagram in bytes; a device's longest has some 400."""

SocketAddress = tuple[str, int, int, int]
"""Address, port, flow label and scope, as an IPv6 socket gives them."""

_HEADER_BYTES = 4
_LONGEST_TOKEN = 8
_NEWEST_METHOD = 7  # iPATCH
_CON, _NON = 0, 1

_Sender = tuple[str, int, int]


@dataclass(slots=True)
class Counters:
    """Counters of datagrams since the endpoint was opened; the last four are part of those received."""

    received: int = 0
    dropped_by_bucket: int = 0
    forged: int = 0
    """OSCORE requests without a valid tag; dropped."""
    junk: int = 0
    failed: int = 0
    """Errors while a datagram was handled or sent; none of them left the endpoint."""


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of datagrams by their sender: a burst (`_at_once`) and a sustained rate (`_per_s`)."""

    strangers_at_once: float = 40
    strangers_per_s: float = 40
    """Rate of all strangers together, so forged addresses get no more."""
    proven_at_once: float = 200
    proven_per_s: float = 200
    """Rate of each sender that proved to hold a key."""
    proven_senders: int = 64
    """Most proven senders; beyond, the one silent for longest becomes a stranger again."""
    tags_at_once: float = 500
    tags_per_s: float = 5_000
    """Rate of tag checks, all keys together: at most a tenth of a core."""
    key_at_once: float = 200
    key_per_s: float = 200
    """Rate of new requests of each key, from all addresses together."""


@dataclass(slots=True)
class _Key:
    """Authentic requests of one key."""

    bucket: TokenBucket
    newest: int
    """Highest sequence number so far."""


class DatagramFilter:
    """Filter of datagrams before they are decoded: plausible requests pass, at a limited rate.

    Senders that have shown a key have rates of their own, so that a flood of strangers does not shut them out.
    """

    def __init__(
        self,
        limits: Limits,
        counters: Counters,
        now: Callable[[], float] = time.monotonic,
        key_of: Callable[[SealedRequest], Any] | None = None,
    ) -> None:
        """Begin with full buckets.

        Args:
            key_of: the security context that an OSCORE request names, or None if there is none. Without `key_of` no
                tag is checked.
        """
        self._limits = limits
        self._counters = counters
        self._now = now
        self._key_of = key_of
        self._strangers = TokenBucket(limits.strangers_at_once, limits.strangers_per_s, now)
        self._tags = TokenBucket(limits.tags_at_once, limits.tags_per_s, now)
        self._proven: OrderedDict[_Sender, TokenBucket] = OrderedDict()
        self._keys: OrderedDict[bytes, _Key] = OrderedDict()

    @property
    def proven_senders(self) -> int:
        """Number of senders with a rate of their own."""
        return len(self._proven)

    def accepts(self, data: bytes, address: SocketAddress) -> bool:
        """Count a datagram; return whether to decode it."""
        self._counters.received += 1
        if not may_be_request(data):
            self.count_junk()
            return False
        sealed = None if self._key_of is None else SealedRequest.parse(data)
        if self._key_of is not None and sealed is not None:
            key = self._key_of(sealed)
            if key is not None and not self._tags.acquire():
                return self._counted(accepted=False)
            if key is None or not sealed.fits(key):
                self._counters.forged += 1
                return False
            if self._is_newest(sealed):
                return self._counted(self._keys[sealed.kid].bucket.acquire())
        sender = (address[0], address[1], address[3])
        bucket = self._proven.get(sender)
        if bucket is None:
            bucket = self._strangers
        else:
            self._proven.move_to_end(sender)
        return self._counted(bucket.acquire())

    def _is_newest(self, sealed: SealedRequest) -> bool:
        """Note an authentic request; return whether its number is the highest of its key."""
        key = self._keys.get(sealed.kid)
        if key is None:
            limits = self._limits
            self._keys[sealed.kid] = _Key(TokenBucket(limits.key_at_once, limits.key_per_s, self._now), sealed.number)
            if len(self._keys) > limits.proven_senders:
                self._keys.popitem(last=False)
            return True
        self._keys.move_to_end(sealed.kid)
        if sealed.number <= key.newest:
            return False
        key.newest = sealed.number
        return True

    def _counted(self, accepted: bool) -> bool:
        self._counters.dropped_by_bucket += not accepted
        return accepted

    def count_junk(self) -> None:
        """Count a datagram that is no CoAP message, as found here or by decoding."""
        self._counters.junk += 1

    def mark_proven(self, address: SocketAddress) -> None:
        """Give a sender that holds a key a rate of its own."""
        sender = (address[0], address[1], address[3])
        if sender in self._proven:
            return
        limits = self._limits
        self._proven[sender] = TokenBucket(limits.proven_at_once, limits.proven_per_s, self._now)
        if len(self._proven) > limits.proven_senders:
            self._proven.popitem(last=False)


def may_be_request(data: bytes) -> bool:
    """Return whether the first four bytes are those of a CoAP request, a ping, or an empty ACK or RST.

    The robot sends no requests, so it gets no answers but ACK and RST to its notifications.
    """
    if not _HEADER_BYTES <= len(data) <= LONGEST_DATAGRAM:
        return False
    version, kind, token_bytes, code = data[0] >> 6, data[0] >> 4 & 0b11, data[0] & 0b1111, data[1]
    if version != 1:
        return False
    if code == 0:
        return kind != _NON and len(data) == _HEADER_BYTES and token_bytes == 0
    return code <= _NEWEST_METHOD and kind in (_CON, _NON) and token_bytes <= _LONGEST_TOKEN
