"""CAN wire with arbitration and bit-exact transmission times."""

from collections.abc import Callable
from dataclasses import dataclass
from threading import RLock

import can

from simbridge.wire.bits import INTERFRAME_BITS, bits_before_ack, bits_to_difference
from simbridge.wire.bus_noise import BusNoise, FrameLoss
from simbridge.wire.error_counters import ErrorState
from simbridge.wire.node import Queued, WireNode
from simbridge.wire.settings import NodeSettings, WireSettings

ERROR_FRAME_BITS = 20
"""Error flag of six bits, up to six of the other nodes' flags, and the delimiter of eight."""
SUSPEND_BITS = 8
"""Pause of an error-passive sender after its frame."""
RECOVERY_BITS = 128 * 11
"""Recessive bits after bus-off before a node participates again."""
_NS_PER_S = 1_000_000_000
_FAR_NS = 1 << 62


@dataclass(frozen=True, slots=True)
class _Transmission:
    """Transmission on the wire; several senders as long as their bits agree."""

    senders: tuple[tuple[WireNode, Queued], ...]
    others: tuple[WireNode, ...]
    """Nodes that acknowledge and receive the frame."""
    start_ns: int
    end_ns: int
    destroyed: bool
    unacknowledged: bool
    """True if the transmission fails for lack of an acknowledgement."""


@dataclass(slots=True)
class WireCounts:
    """Counts of transmissions."""

    carried: int = 0
    destroyed: int = 0
    dropped: int = 0
    """Drops of carried frames, counted per receiver."""
    busy_ns: int = 0
    """Time in which the wire was busy, interframe space included."""


class Wire:
    """Wire between nodes; its time advances only by `advance`, or follows a clock. Thread-safe.

    Once the wire is free, the best of the queued frames starts, and nothing interrupts it. At the end of its last bit
    the other nodes receive it with that timestamp, and its sender gets it back as a confirmation. A frame destroyed by
    noise or by two disagreeing senders of one identifier is followed by an error frame and repeated; the error counters
    follow, up to bus-off. Equal seeds and calls give equal runs.
    """

    def __init__(self, settings: WireSettings, seed: int) -> None:
        self.settings = settings
        self.counts = WireCounts()
        self._ns_per_bit = _NS_PER_S / settings.bit_rate_bit_s
        self._disturbance = BusNoise(settings.noise, seed)
        self._loss = FrameLoss(settings.loss, seed)
        self._lock = RLock()
        self._nodes: list[WireNode] = []
        self._transmission: _Transmission | None = None
        self._now_ns = self._free_ns = 0
        self._clock: Callable[[], float] | None = None
        self._clock_ahead_s = 0.0

    def join(self, settings: NodeSettings) -> WireNode:
        """Return a new controller on the wire; it receives frames that start from now on."""
        with self._lock:
            self._sync_clock()
            node = WireNode(settings, self._now_ns)
            self._nodes.append(node)
            return node

    def unplug(self, node: WireNode) -> None:
        """Unplug a controller: its frame on the wire is finished, its queued ones are lost."""
        with self._lock:
            self._sync_clock()
            node.unplugged = True
            node.queue.clear()
            self._remove_unplugged()

    def enqueue(self, node: WireNode, frame: can.Message) -> None:
        """Queue a copy of a frame. Raises can.CanOperationError if the node's queue is full."""
        with self._lock:
            self._sync_clock()
            node.enqueue(frame.__deepcopy__(None))

    def recv(self, node: WireNode) -> can.Message | None:
        """Return the oldest frame that waits for this node's reader; None without one. Never waits."""
        with self._lock:
            self._sync_clock()
            return node.received.popleft() if node.received else None

    def set_id_filter(self, node: WireNode, frame_ids: frozenset[int]) -> None:
        """Accept only these standard identifiers and error frames for this node."""
        with self._lock:
            self._sync_clock()
            node.set_id_filter(frame_ids)

    def now_s(self) -> float:
        """Return the time in s of the clock that stamps the frames."""
        with self._lock:
            self._sync_clock()
            return self._now_ns / _NS_PER_S

    def advance(self, to_s: float) -> None:
        """Advance the time to `to_s`, never backwards. Without effect while the wire follows a clock."""
        with self._lock:
            self._advance(round(to_s * _NS_PER_S))

    def follow(self, clock: Callable[[], float] | None) -> None:
        """Advance with this clock of seconds from now on; None stops the time until `advance`."""
        with self._lock:
            self._sync_clock()
            self._clock = clock
            if clock is not None:
                self._clock_ahead_s = clock() - self._now_ns / _NS_PER_S

    def _sync_clock(self) -> None:
        if self._clock is not None:
            self._advance(round((self._clock() - self._clock_ahead_s) * _NS_PER_S))

    def _advance(self, to_ns: int) -> None:
        """Carry all frames that end by then; none starts at that very moment, because other nodes may join in."""
        while True:
            on_the_wire = self._transmission
            if on_the_wire is not None:
                if on_the_wire.end_ns > to_ns:
                    break
                self._transmission = None
                self._finish(on_the_wire)
            start_ns = self._next_start_ns()
            waking = self._next_to_restart()
            if (
                waking is not None
                and waking.restarts_at_ns is not None
                and waking.restarts_at_ns <= min(start_ns, to_ns)
            ):
                waking.restart(waking.restarts_at_ns, waking.restarts_at_ns + self._ns(RECOVERY_BITS))
            elif start_ns < to_ns:
                self._transmission = self._begin(start_ns)
            else:
                break
        self._now_ns = max(self._now_ns, to_ns)

    def _next_start_ns(self) -> int:
        # A waiting frame cannot start before the present: `_advance` would have started it.
        waits_ns = [node.waits_until_ns for node in self._nodes if node.queue]
        return max(self._now_ns, self._free_ns, min(waits_ns)) if waits_ns else _FAR_NS

    def _next_to_restart(self) -> WireNode | None:
        off = [node for node in self._nodes if node.restarts_at_ns is not None]
        return min(off, key=lambda node: node.restarts_at_ns or 0) if off else None

    def _begin(self, start_ns: int) -> _Transmission:
        """Arbitrate and return the transmission with its fate."""
        rivals = [node for node in self._nodes if node.queue and node.waits_until_ns <= start_ns]
        best = min([node.queue[0].key for node in rivals])
        senders = tuple((node, node.queue.pop(0)) for node in rivals if node.queue[0].key == best)
        first = senders[0][1]
        end_ns = start_ns + self._ns(first.bits)
        sending = [node for node, _ in senders]
        others = tuple(
            node
            for node in self._nodes
            if not node.is_bus_off and node.receives_from_ns <= start_ns and node not in sending
        )
        error_bit = self._first_error_bit(start_ns, end_ns, [queued.frame for _, queued in senders])
        unacknowledged = error_bit is None and not others
        if unacknowledged:
            error_bit = bits_before_ack(first.bits)
        if error_bit is not None:
            end_ns = start_ns + self._ns(error_bit + 1 + ERROR_FRAME_BITS)
        return _Transmission(senders, others, start_ns, end_ns, error_bit is not None, unacknowledged)

    def _first_error_bit(self, start_ns: int, end_ns: int, frames: list[can.Message]) -> int | None:
        """Return the first bit hit by noise or on which senders disagree; None if there is none."""
        wrong: list[int] = []
        hit_ns = self._disturbance.corrupted_at_ns(start_ns, end_ns)
        if hit_ns is not None:
            wrong.append(int((hit_ns - start_ns) / self._ns_per_bit))
        for other in frames[1:]:
            differs_at = bits_to_difference(frames[0], other)
            if differs_at is not None:
                wrong.append(differs_at)
        return min(wrong) if wrong else None

    def _finish(self, done: _Transmission) -> None:
        """Deliver the frame or requeue it, and update the counters of all participants."""
        self._free_ns = done.end_ns + self._ns(INTERFRAME_BITS)
        self.counts.busy_ns += self._free_ns - done.start_ns
        if done.destroyed:
            self.counts.destroyed += 1
            for node, queued in done.senders:
                node.counters.send_failed(unacknowledged=done.unacknowledged)
                node.requeue(queued)
            for node in done.others:
                node.counters.receive_failed()
                node.update_state(done.end_ns)
        else:
            self._deliver(done)
        for node, _ in done.senders:
            node.update_state(done.end_ns)
            if node.state is ErrorState.PASSIVE:
                node.waits_until_ns = self._free_ns + self._ns(SUSPEND_BITS)
            if node.unplugged:
                self._remove_unplugged()

    def _deliver(self, done: _Transmission) -> None:
        frame, time_s = done.senders[0][1].frame, done.end_ns / _NS_PER_S
        self.counts.carried += 1
        for node, queued in done.senders:
            node.counters.sent()
            node.deliver(queued.frame, time_s, own=True)
        for node in done.others:
            node.counters.received()
            node.update_state(done.end_ns)
            if self._loss.drops(frame):
                self.counts.dropped += 1
            else:
                node.deliver(frame, time_s, own=False)

    def _remove_unplugged(self) -> None:
        sending = [] if self._transmission is None else [node for node, _ in self._transmission.senders]
        self._nodes = [node for node in self._nodes if not node.unplugged or node in sending]

    def _ns(self, bits: int) -> int:
        return round(bits * self._ns_per_bit)
