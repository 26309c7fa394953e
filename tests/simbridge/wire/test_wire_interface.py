"""Ends of a wire: the conformance suite of buses, full queues, threads."""

import threading
from collections.abc import Iterator
from typing import ClassVar

import can
import pytest

from hal.bus import BusError, CanBus
from simbridge.wire.settings import NodeSettings, SendingOrder
from simbridge.wire.wire_interface import WireInterface
from tests.hal.bus_conformance import Behind, BusConformance, Join, joining
from tests.simbridge.wires import ends_on, frame, new_wire, numbered, others_frames

DEEP = NodeSettings(order=SendingOrder.FIFO, queue_frames=256, restart_s=0.1)


class TestWireEnd(BusConformance):
    receives_own_frames: ClassVar[bool] = True
    behind: ClassVar[Behind] = Behind.NEWEST_ARE_LOST
    too_many_frames: ClassVar[int] = 4200

    @pytest.fixture
    def join(self) -> Iterator[Join]:
        wire = self.wire = new_wire()
        with joining(lambda: CanBus("wire", lambda _: WireInterface(wire, DEEP))) as join:
            yield join

    def carry(self) -> None:
        self.wire.advance(self.wire.now_s() + 0.05)


def test_end_with_a_full_queue_raises_until_it_drains() -> None:
    wire = new_wire()
    bus = CanBus("wire", lambda _: WireInterface(wire, DEEP.model_copy(update={"queue_frames": 10})))
    (listener,) = ends_on(wire, 1)
    port = bus.telemetry_port()
    for _ in range(10):
        port.send(frame(0x09))
    with pytest.raises(BusError):
        port.send(frame(0x09))
    wire.advance(0.001)
    port.send(frame(0x0A))
    wire.advance(0.01)
    assert [message.arbitration_id for message in others_frames(listener)] == [0x09] * 10 + [0x0A]


def test_end_after_shutdown_raises() -> None:
    (end,) = ends_on(new_wire(), 1)
    end.shutdown()
    with pytest.raises(can.CanOperationError):
        end.recv(0)
    with pytest.raises(can.CanOperationError):
        end.send(frame(0x09))


def test_ends_in_threads_lose_nothing_and_keep_order() -> None:
    wire = new_wire(bit_rate_bit_s=1_000_000_000)
    senders = ends_on(wire, 3, DEEP.model_copy(update={"queue_frames": 1000}))
    (listener,) = ends_on(wire, 1)
    ticks = iter(range(1_000_000))
    wire.follow(lambda: next(ticks) * 1e-6)  # each call is a microsecond later
    numbers = range(800)

    def send_all(end: WireInterface, frame_id: int) -> None:
        for number in numbers:
            end.send(numbered(frame_id, number))

    threads = [threading.Thread(target=send_all, args=(end, at)) for at, end in enumerate(senders)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    wire.follow(None)
    wire.advance(10.0)
    heard = others_frames(listener)
    for at in range(len(senders)):
        assert [int.from_bytes(each.data, "big") for each in heard if each.arbitration_id == at] == list(numbers)
