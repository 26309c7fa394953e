"""Filter in front of aiocoap: a flood must end here, in microseconds, and leave nothing in memory.

A sender can forge its address and copy a key id, so neither buys work:

- An OSCORE request is dropped if no key of ours has its key id, or if that key did not make its tag. Checking a tag
  costs some 20 µs and has a rate of its own.
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
from kurt2rt.channel.server.token_bucket import TokenBucket

LONGEST_DATAGRAM = 1500
"""Bytes; the longest of ours has some 400."""

SocketAddress = tuple[str, int, int, int]
"""Address, port, flow label and scope, as an IPv6 socket gives them."""

_HEADER_BYTES = 4
_LONGEST_TOKEN = 8
_NEWEST_METHOD = 7  # iPATCH
_CON, _NON = 0, 1

_Sender = tuple[str, int, int]


@dataclass(slots=True)
class Counters:
    """Datagrams counted since the endpoint was opened; the last four counters are part of those received."""

    received: int = 0
    dropped_by_bucket: int = 0
    forged: int = 0
    """OSCORE requests that no key of ours made; dropped."""
    junk: int = 0
    failed: int = 0
    """Errors while a datagram was handled or sent; none of them left the endpoint."""


@dataclass(frozen=True, slots=True)
class Limits:
    """How many datagrams are let in at once, and for good."""

    strangers_at_once: float = 40
    strangers_per_s: float = 40
    """All together: who forges addresses gets no more."""
    proven_at_once: float = 200
    proven_per_s: float = 200
    """Each sender who proved that he holds a key."""
    proven_senders: int = 64
    """Who was not heard for longest is a stranger again."""
    tags_at_once: float = 500
    tags_per_s: float = 5_000
    """Tags checked, all keys together: at most a tenth of a core."""
    key_at_once: float = 200
    key_per_s: float = 200
    """New requests of each key, from all addresses together."""


@dataclass(slots=True)
class _Key:
    """Requests of one key that were certainly made with it."""

    bucket: TokenBucket
    newest: int
    """Highest sequence number so far."""


class DatagramFilter:
    """Accepts what may be a request and comes at a bearable rate."""

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
        """How many senders have a rate of their own."""
        return len(self._proven)

    def admits(self, data: bytes, address: SocketAddress) -> bool:
        """Whether to decode a datagram; counts it."""
        self._counters.received += 1
        if not may_be_request(data):
            self.count_junk()
            return False
        sealed = None if self._key_of is None else SealedRequest.parse(data)
        if self._key_of is not None and sealed is not None:
            key = self._key_of(sealed)
            if key is not None and not self._tags.take():
                return self._counted(admitted=False)
            if key is None or not sealed.fits(key):
                self._counters.forged += 1
                return False
            if self._is_newest(sealed):
                return self._counted(self._keys[sealed.kid].bucket.take())
        sender = (address[0], address[1], address[3])
        bucket = self._proven.get(sender)
        if bucket is None:
            bucket = self._strangers
        else:
            self._proven.move_to_end(sender)
        return self._counted(bucket.take())

    def _is_newest(self, sealed: SealedRequest) -> bool:
        """Note an authentic request; whether its number is higher than all before it."""
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

    def _counted(self, admitted: bool) -> bool:
        self._counters.dropped_by_bucket += not admitted
        return admitted

    def count_junk(self) -> None:
        """A datagram that is none of CoAP's; also called for what only its decoding showed."""
        self._counters.junk += 1

    def proved(self, address: SocketAddress) -> None:
        """This sender has just sent what only the holder of a key can make."""
        sender = (address[0], address[1], address[3])
        if sender in self._proven:
            return
        limits = self._limits
        self._proven[sender] = TokenBucket(limits.proven_at_once, limits.proven_per_s, self._now)
        if len(self._proven) > limits.proven_senders:
            self._proven.popitem(last=False)


def may_be_request(data: bytes) -> bool:
    """Whether the first four bytes are those of a CoAP request, of a ping, or of an empty ACK or RST.

    A robot asks for nothing, so it gets no other answers than ACK and RST to its notifications.
    """
    if not _HEADER_BYTES <= len(data) <= LONGEST_DATAGRAM:
        return False
    version, kind, token_bytes, code = data[0] >> 6, data[0] >> 4 & 0b11, data[0] & 0b1111, data[1]
    if version != 1:
        return False
    if code == 0:
        return kind != _NON and len(data) == _HEADER_BYTES and token_bytes == 0
    return code <= _NEWEST_METHOD and kind in (_CON, _NON) and token_bytes <= _LONGEST_TOKEN
