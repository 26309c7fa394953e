"""Waiting times stay below the bound of Davis, Burns, Bril and Lukkien (Real-Time Systems 35, 2007)."""

from dataclasses import dataclass
from math import ceil

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from hal.frame import Frame
from simbridge.wire.wire import Wire
from tests.examples import examples
from tests.simbridge.wires import BY_IDENTIFIER, US, confirmations, ends_on, new_wire, stamp_us

SPAN_US = 30_000


@dataclass(frozen=True)
class Stream:
    """Frame queued periodically; microseconds, which are bits here."""

    frame_id: int
    data_bytes: int
    period_us: int
    offset_us: int
    node: int

    @property
    def longest_us(self) -> int:
        return 55 + 10 * self.data_bytes


def worst_response_us(stream: Stream, streams: list[Stream]) -> int:
    """Return the longest time from queueing to the end of a frame in the busy period (equations 5 to 9, no jitter)."""
    better = [each for each in streams if each.frame_id < stream.frame_id]
    blocking = max((each.longest_us for each in streams if each.frame_id > stream.frame_id), default=0)
    busy, before = stream.longest_us, 0
    while busy != before:
        before = busy
        busy = blocking + sum(ceil(before / each.period_us) * each.longest_us for each in [*better, stream])
    worst = 0
    for instance in range(ceil(busy / stream.period_us)):
        waited, before = blocking + instance * stream.longest_us, -1
        while waited != before:
            before = waited
            waited = blocking + instance * stream.longest_us
            waited += sum(ceil((before + 1) / each.period_us) * each.longest_us for each in better)
        worst = max(worst, waited - instance * stream.period_us + stream.longest_us)
    return worst


@st.composite
def schedulable(draw: st.DrawFn) -> list[Stream]:
    ids = draw(st.lists(st.integers(0, 0x7FF), min_size=2, max_size=8, unique=True))
    streams = [
        Stream(
            frame_id,
            draw(st.integers(0, 8)),
            draw(st.integers(400, 5000)),
            draw(st.integers(0, 2000)),
            draw(st.integers(0, 2)),
        )
        for frame_id in ids
    ]
    assume(sum(each.longest_us / each.period_us for each in streams) < 0.95)
    return streams


def longest_waits_us(wire: Wire, streams: list[Stream], payloads: st.DataObject) -> dict[int, int]:
    nodes = ends_on(wire, 4, BY_IDENTIFIER)
    queued = sorted(
        (at_us, stream.frame_id, stream)
        for stream in streams
        for at_us in range(stream.offset_us, SPAN_US, stream.period_us)
    )
    sent_us: dict[int, list[int]] = {stream.frame_id: [] for stream in streams}
    fill = payloads.draw(st.binary(min_size=16, max_size=16))
    for number, (at_us, frame_id, stream) in enumerate(queued):
        wire.advance(at_us * US)
        turn = number % 8
        nodes[stream.node].send(Frame(frame_id, fill[turn : turn + stream.data_bytes]))
        sent_us[frame_id].append(at_us)
    wire.advance(1.0)
    longest: dict[int, int] = dict.fromkeys(sent_us, 0)
    for node in nodes:
        for message in confirmations(node):
            waited_us = stamp_us(message) - sent_us[message.arbitration_id].pop(0)
            longest[message.arbitration_id] = max(longest[message.arbitration_id], waited_us)
    assert not any(sent_us.values())
    return longest


def check_waits(streams: list[Stream], payloads: st.DataObject) -> None:
    longest_us = longest_waits_us(new_wire(), streams, payloads)
    for stream in streams:
        assert longest_us[stream.frame_id] <= worst_response_us(stream, streams)


@given(schedulable(), st.data())
def test_wire_waits_stay_below_the_analysed_bound(streams: list[Stream], payloads: st.DataObject) -> None:
    check_waits(streams, payloads)


@pytest.mark.deep
@examples(3000)
@given(schedulable(), st.data())
def test_wire_many_waits_stay_below_the_analysed_bound(streams: list[Stream], payloads: st.DataObject) -> None:
    check_waits(streams, payloads)


def test_wire_worst_case_comes_close_to_the_bound() -> None:
    """Proof that the check above can fail: the worst case is within the stuffing of a few CRCs of the bound."""
    wire = new_wire()
    nodes = ends_on(wire, 4, BY_IDENTIFIER)
    streams = [Stream(frame_id, 8, 10_000, 0, 0) for frame_id in (0x000, 0x001, 0x002, 0x003)]
    nodes[3].send(Frame(0x00F, bytes(8)))
    wire.advance(1 * US)
    for node, stream in zip((0, 1, 2, 0), streams, strict=True):
        nodes[node].send(Frame(stream.frame_id, bytes(8)))
    wire.advance(0.01)
    bound_us = worst_response_us(streams[-1], [*streams, Stream(0x00F, 8, 10_000, 0, 3)])
    waited_us = max(stamp_us(message) for message in confirmations(nodes[0])) - 1
    assert bound_us == 5 * 135
    assert 0.9 * bound_us < waited_us <= bound_us
