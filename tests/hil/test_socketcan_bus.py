"""The kernel's CAN behaves as every bus does; and what only the kernel does: echoes, filters, links that go down.

A frame that was sent is on its way: under load the kernel hands it to its listeners some milliseconds later.
"""

import select
import subprocess
from collections.abc import Iterator

import can
import pytest

from hal.bus import BusError, CanBus, FramePort, open_bus
from hal.control import encode_brake
from hal.frame import Frame
from tests.hal.bus_conformance import (
    BUS_OFF,
    EXTENDED,
    REMOTE,
    RESTARTED,
    Behind,
    Ends,
    ErrorFrameConformance,
    Join,
    identity,
    joining,
)
from tests.hal.helpers import cycle, send

pytestmark = pytest.mark.hil


MARK = can.Message(arbitration_id=0x1FFF_FFFF, is_extended_id=True, data=b"the last")


def take(bus: CanBus, count: int) -> list[can.Message]:
    """So many frames, waited for."""
    frames = bus.drain()
    while len(frames) < count:
        await_something(bus)
        frames += bus.drain()
    return frames


def await_something(bus: CanBus) -> None:
    end = bus._can_interface
    assert isinstance(end, can.BusABC)
    assert select.select([end], [], [], 20.0)[0]


def link(*words: str) -> None:
    subprocess.run(["ip", "link", *words], check=True, capture_output=True)


@pytest.fixture
def ends(vcan0: str) -> Iterator[Ends]:
    with joining(lambda: open_bus(vcan0)) as join:
        yield join(), join()


@pytest.fixture
def passing_interface() -> Iterator[str]:
    """Return an interface that a test may delete."""
    name = "vcan77"
    link("add", "dev", name, "type", "vcan")
    link("set", name, "up")
    yield name
    subprocess.run(["ip", "link", "del", name], check=False, capture_output=True)


@pytest.fixture
def link_goes_down_and_up(vcan0: str) -> Iterator[str]:
    yield vcan0
    link("set", vcan0, "up")


class TestSocketCan(ErrorFrameConformance):
    receives_own_frames = True
    behind = Behind.NEWEST_ARE_LOST

    @pytest.fixture
    def join(self, vcan0: str) -> Iterator[Join]:
        mark = [{"can_id": MARK.arbitration_id, "can_mask": 0x1FFF_FFFF, "extended": True}]
        with (
            joining(lambda: open_bus(vcan0)) as join,
            can.Bus("vcan0", "socketcan", can_filters=mark, receive_own_messages=True, ignore_config=True) as marker,
        ):
            self.marker = marker
            yield join

    @pytest.fixture
    def ends(self, join: Join) -> Ends:
        return join(), join()

    def heard(self, end: CanBus) -> list[can.Message]:
        self.marker.send(MARK)
        assert self.marker.recv(20.0) is not None
        return [frame for frame in super().heard(end) if frame.arbitration_id != MARK.arbitration_id]


@pytest.mark.parametrize("sent", [*cycle(), Frame(0x7FF, b""), EXTENDED, REMOTE, BUS_OFF, RESTARTED])
def test_python_can_hears_and_says_the_same_frames(ends: Ends, vcan0: str, sent: can.Message) -> None:
    robot_end, far_end = ends
    with can.Bus(interface="socketcan", channel=vcan0, ignore_config=True) as foreign:
        send(far_end, [sent])
        heard = foreign.recv(20.0)
        assert heard is not None
        assert identity(heard) == identity(sent)
        take(robot_end, 1)
        foreign.send(sent)
        assert [identity(frame) for frame in take(robot_end, 1)] == [identity(sent)]


def test_bus_link_down_raises_until_up_and_reopened(ends: Ends, link_goes_down_and_up: str) -> None:
    robot_end, far_end = ends
    name = link_goes_down_and_up
    robot_end.set_id_filter({0x09})
    link("set", name, "down")
    for _ in range(3):
        with pytest.raises(BusError, match=f"receiving.* {name} up"):
            robot_end.drain()
        with pytest.raises(BusError, match=f"sending.* {name} up"):
            send(robot_end, cycle())
        with pytest.raises(BusError, match=f"'{name}': .* {name} up"):
            open_bus(name)
    with pytest.raises(BusError, match=f" {name} up"):
        robot_end.reopen()
    with pytest.raises(BusError, match="shut down"):
        robot_end.drain()
    link("set", name, "up")
    robot_end.reopen()
    assert robot_end.drain() == []
    far_end.reopen()
    send(far_end, [Frame(0x08, b""), Frame(0x09, b"x")])
    assert [frame.arbitration_id for frame in take(robot_end, 1)] == [0x09]


def test_bus_link_down_noticed_by_send_is_raised_by_drain(ends: Ends, link_goes_down_and_up: str) -> None:
    robot_end, _ = ends
    control = robot_end.control_port()
    link("set", link_goes_down_and_up, "down")
    for _ in range(2):
        with pytest.raises(BusError, match="sending failed"):
            control.send(encode_brake())
    assert control.unconfirmed == 0  # it never left
    link("set", link_goes_down_and_up, "up")
    control.send(encode_brake())  # a brake is tried all the same
    with pytest.raises(BusError, match="receiving failed"):
        robot_end.drain()


def test_bus_unplugged_adapter_raises_until_plugged_in(passing_interface: str) -> None:
    robot_end = open_bus(passing_interface)
    link("del", passing_interface)
    for _ in range(3):
        with pytest.raises(BusError, match="receiving"):
            robot_end.drain()
        with pytest.raises(BusError, match=r"sending.* gone"):
            send(robot_end, cycle())
    with pytest.raises(BusError, match=f"bus '{passing_interface}': "):
        robot_end.reopen()
    link("add", "dev", passing_interface, "type", "vcan")
    link("set", passing_interface, "up")
    robot_end.reopen()
    far_end = open_bus(passing_interface)
    send(far_end, cycle())
    assert len(take(robot_end, len(cycle()))) == len(cycle())
    far_end.shutdown()
    robot_end.shutdown()


def test_filters_are_the_kernels(ends: Ends) -> None:
    robot_end, far_end = ends
    robot_end.set_id_filter({0x09})
    send(far_end, (Frame(0x0A, b"") for _ in range(6000)))  # more than wait for a listener
    send(far_end, [Frame(0x09, b"x")])
    assert [frame.arbitration_id for frame in take(robot_end, 1)] == [0x09]
    assert robot_end.overruns == 0


def test_bus_full_queue_raises_and_confirms_no_frame(passing_interface: str) -> None:
    # One frame at once, the next ones hardly ever: a bus that does not acknowledge.
    queue("add", passing_interface, "tbf", "rate", "8bit", "burst", "16", "limit", "160")
    robot_end = open_bus(passing_interface)
    control = robot_end.control_port()
    with pytest.raises(BusError, match=r"sending.* queue"):
        send_until_full(control)
    held = control.unconfirmed
    assert held >= 2
    assert robot_end.drain() == []
    assert held - control.unconfirmed <= 1
    robot_end.shutdown()


def test_bus_own_control_is_confirmed_only_after_transmission(passing_interface: str) -> None:
    queue("add", passing_interface, "netem", "delay", "100ms")
    robot_end = open_bus(passing_interface)
    control = robot_end.control_port()
    control.send(encode_brake())
    assert robot_end.drain() == []
    assert control.unconfirmed == 1
    await_something(robot_end)
    assert robot_end.drain() == []
    assert control.unconfirmed == 0
    robot_end.shutdown()


def queue(verb: str, interface: str, *words: str) -> None:
    subprocess.run(["tc", "qdisc", verb, "dev", interface, "root", *words], check=True, capture_output=True)


def send_until_full(port: FramePort) -> None:
    for _ in range(1000):
        port.send(encode_brake())
