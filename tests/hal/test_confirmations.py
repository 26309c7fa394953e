"""Count of own CONTROL frames that the bus has not carried yet."""

from collections import deque

import can
import pytest

from hal.bus import CONTROL_ID, BusError, CanBus, FramePort
from hal.control import encode_brake
from hal.frame import Frame
from tests.hal.bus_conformance import BUS_OFF, RESTARTED
from tests.hal.helpers import cycle

SLOW = Frame(CONTROL_ID, bytes((0, 2, 0, 1, 0, 1, 0, 1)))
FAST = Frame(CONTROL_ID, bytes((0, 2, 0, 9, 0, 1, 0, 9)))


class HeldEnd:
    """An end (hal.bus.CanInterface) whose controller sends only what it is told to."""

    receives_own_frames = True

    def __init__(self) -> None:
        self.overruns = 0
        self.held: deque[can.Message] = deque()
        self.arrived: deque[can.Message] = deque()
        self.at_once: CanBus | None = None
        self.is_full = False

    def now_s(self) -> float | None:
        return None

    def set_id_filter(self, frame_ids: frozenset[int]) -> None:
        if CONTROL_ID not in frame_ids:
            raise ValueError("confirmations would be filtered out")

    def recv(self, timeout: float | None) -> can.Message | None:
        assert timeout == 0
        return self.arrived.popleft() if self.arrived else None

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        assert timeout == 0
        if self.is_full:
            raise can.CanOperationError("the transmit queue is full")
        self.held.append(
            can.Message(arbitration_id=msg.arbitration_id, data=msg.data, is_extended_id=False, is_rx=False)
        )
        if self.at_once is not None:
            self.carry()
            self.at_once.drain()

    def carry(self, frames: int = 1) -> None:
        for _ in range(frames):
            self.arrived.append(self.held.popleft())

    def shutdown(self) -> None:
        self.held.clear()


@pytest.fixture
def end() -> HeldEnd:
    return HeldEnd()


@pytest.fixture
def bus(end: HeldEnd) -> CanBus:
    return CanBus("held", lambda _: end)


@pytest.fixture
def port(bus: CanBus) -> FramePort:
    return bus.control_port()


def test_frames_wait_until_the_bus_has_carried_them(end: HeldEnd, bus: CanBus, port: FramePort) -> None:
    for _ in range(3):
        port.send(encode_brake())
    assert port.unconfirmed == 3
    end.carry(2)
    assert port.unconfirmed == 3  # as far as the last drain knows
    assert bus.drain() == []
    assert port.unconfirmed == 1


def test_other_frames_neither_wait_nor_confirm(end: HeldEnd, bus: CanBus, port: FramePort) -> None:
    port.send(encode_brake())
    bus.telemetry_port().send(cycle()[0])
    end.held.rotate()
    end.carry()
    assert bus.drain() == []
    assert port.unconfirmed == 1


def test_a_frame_that_the_bus_did_not_take_is_not_waited_for(end: HeldEnd, port: FramePort) -> None:
    end.is_full = True
    with pytest.raises(BusError, match="held: sending"):
        port.send(encode_brake())
    assert port.unconfirmed == 0


def test_a_frame_that_is_back_before_sending_returns_counts(end: HeldEnd, bus: CanBus, port: FramePort) -> None:
    end.at_once = bus  # the loop drains while the watchdog's thread sends
    port.send(encode_brake())
    assert port.unconfirmed == 0


@pytest.mark.parametrize("report", [BUS_OFF, RESTARTED])
def test_frames_lost_by_a_controller_reset_are_not_awaited(
    end: HeldEnd, bus: CanBus, port: FramePort, report: can.Message
) -> None:
    port.send(encode_brake())
    port.send(encode_brake())
    end.arrived.append(report)
    assert bus.drain() == [report]
    assert port.unconfirmed == 0
    end.carry(2)  # it had not forgotten after all
    bus.drain()
    port.send(encode_brake())
    assert port.unconfirmed == 1


def test_confirmations_that_were_lost_are_not_waited_for(end: HeldEnd, bus: CanBus, port: FramePort) -> None:
    port.send(encode_brake())
    end.overruns = 5
    assert bus.drain() == []
    assert (port.unconfirmed, bus.overruns) == (0, 5)
    port.send(encode_brake())
    bus.drain()
    assert port.unconfirmed == 1


def test_silently_lost_frames_can_be_forgotten(end: HeldEnd, bus: CanBus, port: FramePort) -> None:
    port.send(encode_brake())
    port.send(encode_brake())
    end.held.clear()
    port.forget_unconfirmed()
    assert port.unconfirmed == 0
    port.send(encode_brake())
    assert port.unconfirmed == 1
    end.carry()
    bus.drain()
    assert port.unconfirmed == 0


def test_late_forgotten_frame_confirms_no_newer_frame(end: HeldEnd, bus: CanBus, port: FramePort) -> None:
    port.send(encode_brake())
    port.forget_unconfirmed()
    for _ in range(3):
        port.send(encode_brake())
    end.carry(4)
    bus.drain()
    assert port.unconfirmed == 0
    port.send(encode_brake())
    assert port.unconfirmed == 1


def test_late_brakes_do_not_confirm_later_set_points(end: HeldEnd, bus: CanBus, port: FramePort) -> None:
    for _ in range(6):
        port.send(encode_brake())
    port.forget_unconfirmed()
    for sent in range(1, 4):
        port.send(SLOW)
        end.carry()
        bus.drain()
        assert port.unconfirmed == sent
    end.carry(3)
    assert port.unconfirmed == 3
    end.carry()
    bus.drain()
    assert port.unconfirmed == 2


def test_newer_confirmation_ends_the_wait_for_forgotten_frames(end: HeldEnd, bus: CanBus, port: FramePort) -> None:
    for _ in range(6):
        port.send(encode_brake())
    end.held.clear()
    port.forget_unconfirmed()
    for frame in (SLOW, SLOW, encode_brake(), encode_brake()):
        port.send(frame)
        end.carry()
        bus.drain()
        assert port.unconfirmed == 0


def test_refused_frame_is_not_the_first_since_forgetting(end: HeldEnd, bus: CanBus, port: FramePort) -> None:
    port.send(encode_brake())
    port.forget_unconfirmed()
    end.is_full = True
    with pytest.raises(BusError):
        port.send(SLOW)
    end.is_full = False
    for frame in (encode_brake(), FAST, FAST):
        port.send(frame)
        end.carry()
    end.carry()
    bus.drain()
    assert port.unconfirmed == 0


@pytest.mark.parametrize("happens", ["restarted", "lost", "reopened"])
def test_controller_reset_ends_the_wait_for_forgotten_frames(
    end: HeldEnd, bus: CanBus, port: FramePort, happens: str
) -> None:
    port.send(encode_brake())
    port.forget_unconfirmed()
    port.send(SLOW)
    match happens:
        case "restarted":
            end.arrived.append(RESTARTED)
        case "lost":
            end.overruns = 1
        case "reopened":
            bus.reopen()
    end.held.clear()
    if happens != "reopened":
        bus.drain()
    end.overruns = 0 if happens != "lost" else 1
    assert port.unconfirmed == 0
    port.send(encode_brake())
    end.carry()
    bus.drain()
    assert port.unconfirmed == 0
