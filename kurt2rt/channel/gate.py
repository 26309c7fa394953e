"""Which datagrams are worth decoding: a flood must end here, in microseconds, and leave nothing in memory."""

import time
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass

from kurt2rt.channel.token_bucket import TokenBucket

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
    """What came in since the endpoint was opened; the last three are among those received."""

    received: int = 0
    dropped_by_bucket: int = 0
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


class Gate:
    """Lets in what may be a request and comes at a bearable rate."""

    def __init__(self, limits: Limits, counters: Counters, now: Callable[[], float] = time.monotonic) -> None:
        self._limits = limits
        self._counters = counters
        self._now = now
        self._strangers = TokenBucket(limits.strangers_at_once, limits.strangers_per_s, now)
        self._proven: OrderedDict[_Sender, TokenBucket] = OrderedDict()

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
        sender = (address[0], address[1], address[3])
        bucket = self._proven.get(sender)
        if bucket is None:
            bucket = self._strangers
        else:
            self._proven.move_to_end(sender)
        if bucket.take():
            return True
        self._counters.dropped_by_bucket += 1
        return False

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
