"""The wire: one frame at a time, by arbitration, bit for bit as long as a real one takes."""

from collections.abc import Callable
from dataclasses import dataclass
from threading import RLock

import can

from simbridge.wire.bits import INTERFRAME_BITS, bits_before_ack, bits_to_difference
from simbridge.wire.disturbance import BusNoise, FrameLoss
from simbridge.wire.error_counters import ErrorState
from simbridge.wire.node import Queued, WireNode
from simbridge.wire.settings import NodeSettings, WireSettings

ERROR_FRAME_BITS = 20
"""Error flag of six bits, the flags of others that answer it, six at most, and the delimiter of eight."""
SUSPEND_BITS = 8
"""An error-passive sender lets others go first for so long after its frame."""
RECOVERY_BITS = 128 * 11
"""Recessive bits that a node waits for after bus-off before it takes part again."""
_NS_PER_S = 1_000_000_000
_FAR_NS = 1 << 62


@dataclass(frozen=True, slots=True)
class _Transmission:
    """What is on the wire now; more than one sender only while they send the same bits."""

    senders: tuple[tuple[WireNode, Queued], ...]
    others: tuple[WireNode, ...]
    """Who follows it: acknowledges it and takes it."""
    start_ns: int
    end_ns: int
    destroyed: bool
    unacknowledged: bool
    """Destroyed for want of anybody who acknowledges it."""


@dataclass(slots=True)
class WireCounts:
    """What became of the transmissions so far."""

    carried: int = 0
    destroyed: int = 0
    missed: int = 0
    """Carried frames that a receiver missed, counted for each."""
    busy_ns: int = 0
    """Time in which the wire was taken, interframe space included."""


class Wire:
    """Carries frames between its nodes. Its time goes on by `advance` alone, or follows a clock. Thread safe.

    A frame begins when the wire is free, the best of what the nodes offer then, and nothing interrupts it. Everybody
    else gets it at the end of its last bit, with that time as its stamp, and its sender gets it back as a confirmation.
    A frame that is destroyed, by noise or because two senders of one identifier disagree, is followed by an error frame
    and sent again; the error counters follow, up to bus-off. The same seed and calls give the same run.
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
        """A new controller on the wire, which hears what begins from now on."""
        with self._lock:
            self._follow_clock()
            node = WireNode(settings, self._now_ns)
            self._nodes.append(node)
            return node

    def leave(self, node: WireNode) -> None:
        """Unplug a controller: what it has on the wire is finished, what it has queued is gone with it."""
        with self._lock:
            self._follow_clock()
            node.leaving = True
            node.queue.clear()
            self._forget_gone()

    def put(self, node: WireNode, frame: can.Message) -> None:
        """Queue a copy of a frame. Raises can.CanOperationError when the node's queue is full."""
        with self._lock:
            self._follow_clock()
            node.put(frame.__deepcopy__(None))

    def take(self, node: WireNode) -> can.Message | None:
        """The frame that waits longest for this node's reader; None: there is none."""
        with self._lock:
            self._follow_clock()
            return node.heard.popleft() if node.heard else None

    def set_id_filter(self, node: WireNode, frame_ids: frozenset[int]) -> None:
        """Keep only frames with these standard identifiers, and error frames, for this node's reader."""
        with self._lock:
            self._follow_clock()
            node.set_id_filter(frame_ids)

    def now_s(self) -> float:
        """The present on the clock that stamps the frames."""
        with self._lock:
            self._follow_clock()
            return self._now_ns / _NS_PER_S

    def advance(self, to_s: float) -> None:
        """Let time go on, to no earlier than the present. Of no use while the wire follows a clock."""
        with self._lock:
            self._advance(round(to_s * _NS_PER_S))

    def follow(self, clock: Callable[[], float] | None) -> None:
        """Go on from the present as this clock of seconds does; None: stand still until `advance`."""
        with self._lock:
            self._follow_clock()
            self._clock = clock
            if clock is not None:
                self._clock_ahead_s = clock() - self._now_ns / _NS_PER_S

    def _follow_clock(self) -> None:
        if self._clock is not None:
            self._advance(round((self._clock() - self._clock_ahead_s) * _NS_PER_S))

    def _advance(self, to_ns: int) -> None:
        """Carry all that ends by then. What could begin at that very moment waits: others may still join in."""
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
        # Whatever is queued could not begin before the present, or it would have.
        waits_ns = [node.waits_until_ns for node in self._nodes if node.queue]
        return max(self._now_ns, self._free_ns, min(waits_ns)) if waits_ns else _FAR_NS

    def _next_to_restart(self) -> WireNode | None:
        off = [node for node in self._nodes if node.restarts_at_ns is not None]
        return min(off, key=lambda node: node.restarts_at_ns or 0) if off else None

    def _begin(self, start_ns: int) -> _Transmission:
        """Arbitration, and what will become of the frame that wins it."""
        rivals = [node for node in self._nodes if node.queue and node.waits_until_ns <= start_ns]
        best = min([node.queue[0].key for node in rivals])
        senders = tuple((node, node.queue.pop(0)) for node in rivals if node.queue[0].key == best)
        first = senders[0][1]
        end_ns = start_ns + self._ns(first.bits)
        sending = [node for node, _ in senders]
        others = tuple(
            node for node in self._nodes if not node.off and node.hears_from_ns <= start_ns and node not in sending
        )
        wrong_bit = self._wrong_bit(start_ns, end_ns, [queued.frame for _, queued in senders])
        unacknowledged = wrong_bit is None and not others
        if unacknowledged:
            wrong_bit = bits_before_ack(first.bits)
        if wrong_bit is not None:
            end_ns = start_ns + self._ns(wrong_bit + 1 + ERROR_FRAME_BITS)
        return _Transmission(senders, others, start_ns, end_ns, wrong_bit is not None, unacknowledged)

    def _wrong_bit(self, start_ns: int, end_ns: int, frames: list[can.Message]) -> int | None:
        """The first bit that noise hits, or that two senders of one identifier see differently; None: there is none."""
        wrong: list[int] = []
        strike_ns = self._disturbance.corrupted_at_ns(start_ns, end_ns)
        if strike_ns is not None:
            wrong.append(int((strike_ns - start_ns) / self._ns_per_bit))
        for other in frames[1:]:
            differs_at = bits_to_difference(frames[0], other)
            if differs_at is not None:
                wrong.append(differs_at)
        return min(wrong) if wrong else None

    def _finish(self, done: _Transmission) -> None:
        """Deliver it or have it sent again; the counters of everybody who took part follow."""
        self._free_ns = done.end_ns + self._ns(INTERFRAME_BITS)
        self.counts.busy_ns += self._free_ns - done.start_ns
        if done.destroyed:
            self.counts.destroyed += 1
            for node, queued in done.senders:
                node.counters.send_failed(unacknowledged=done.unacknowledged)
                node.put_back(queued)
            for node in done.others:
                node.counters.receive_failed()
                node.note_state(done.end_ns)
        else:
            self._deliver(done)
        for node, _ in done.senders:
            node.note_state(done.end_ns)
            if node.state is ErrorState.PASSIVE:
                node.waits_until_ns = self._free_ns + self._ns(SUSPEND_BITS)
            if node.leaving:
                self._forget_gone()

    def _deliver(self, done: _Transmission) -> None:
        frame, time_s = done.senders[0][1].frame, done.end_ns / _NS_PER_S
        self.counts.carried += 1
        for node, queued in done.senders:
            node.counters.sent()
            node.hear(queued.frame, time_s, own=True)
        for node in done.others:
            node.counters.received()
            node.note_state(done.end_ns)
            if self._loss.drops(frame):
                self.counts.missed += 1
            else:
                node.hear(frame, time_s, own=False)

    def _forget_gone(self) -> None:
        sending = [] if self._transmission is None else [node for node, _ in self._transmission.senders]
        self._nodes = [node for node in self._nodes if not node.leaving or node in sending]

    def _ns(self, bits: int) -> int:
        return round(bits * self._ns_per_bit)
