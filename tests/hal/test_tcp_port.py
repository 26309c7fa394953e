"""TCP connections as ports: they carry bytes, and a lost one raises until the robot is back."""

import socket
import time
from collections.abc import Callable

import pytest

from hal.bus import BusError
from hal.tcp_port import TcpPort
from simbridge.tcp_listener import TcpListener
from tests.patience import PATIENCE_S


def wait_for(what: Callable[[], bool]) -> None:
    """Wait until something holds; the kernel carries bytes between the ends."""
    ends_s = time.monotonic() + PATIENCE_S
    while not what():
        assert time.monotonic() < ends_s, "nothing came"
        time.sleep(0.002)


def heard(port: TcpPort | TcpListener, expected: bytes) -> bool:
    found = b""

    def whole() -> bool:
        nonlocal found
        found += port.read()
        return len(found) >= len(expected)

    wait_for(whole)
    return found == expected


def is_lost(port: TcpPort) -> bool:
    try:
        port.read()
    except BusError:
        return True
    return False


def is_back(port: TcpPort) -> bool:
    try:
        port.reopen()
    except BusError:
        return False
    return True


def test_bytes_go_both_ways() -> None:
    robot = TcpListener("127.0.0.1:0")
    port = TcpPort(robot.address)
    port.write(b"drive\n")
    assert heard(robot, b"drive\n")
    robot.write(b"sense\n")
    assert heard(port, b"sense\n")
    wait_for(lambda: port.waiting == 0)
    assert (port.read(), robot.read()) == (b"", b"")
    port.close()
    robot.close()


def test_lost_connection_raises_until_the_robot_is_back() -> None:
    robot = TcpListener("127.0.0.1:0")
    address = robot.address
    port = TcpPort(address)
    port.write(b"drive\n")
    assert heard(robot, b"drive\n")
    robot.close()
    wait_for(lambda: is_lost(port))
    assert is_lost(port)
    with pytest.raises(BusError, match=rf"TCP {address}: .*; switch the robot on"):
        port.reopen()
    assert not is_back(port)
    with pytest.raises(BusError, match="is not connected"):
        port.write(b"drive\n")
    robot = TcpListener(address)
    wait_for(lambda: is_back(port))
    port.write(b"again\n")
    assert heard(robot, b"again\n")
    port.close()
    port.close()
    robot.close()
    robot.close()
    assert port.waiting == 0


def test_port_whose_program_does_not_read_takes_no_more() -> None:
    robot = TcpListener("127.0.0.1:0")
    port = TcpPort(robot.address)

    def fill() -> None:
        for _ in range(10_000):
            port.write(bytes(1 << 16))

    with pytest.raises(BusError, match=r"takes no more bytes|temporarily unavailable"):
        fill()
    assert port.waiting > 0
    port.close()
    robot.close()


def test_newest_program_is_the_one_that_is_heard() -> None:
    robot = TcpListener("127.0.0.1:0")
    first = TcpPort(robot.address)
    first.write(b"first\n")
    assert heard(robot, b"first\n")
    second = TcpPort(robot.address)
    second.write(b"second\n")
    assert heard(robot, b"second\n")
    wait_for(lambda: is_lost(first))
    second.close()
    wait_for(lambda: robot.read() == b"" and robot._program is None)
    robot.write(b"lost\n")
    first.close()
    robot.close()


@pytest.mark.parametrize("address", ["nowhere", "127.0.0.1:", ":7000", "127.0.0.1:70000", "127.0.0.1:x"])
def test_address_without_host_and_port_is_refused(address: str) -> None:
    with pytest.raises(BusError, match="is no address; give HOST:PORT"):
        TcpPort(address)


def test_address_at_which_nothing_listens_is_refused() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        address = f"127.0.0.1:{taken.getsockname()[1]}"
        with pytest.raises(BusError, match="cannot listen there"):
            TcpListener(address)
    with pytest.raises(BusError, match="refused"):
        TcpPort(address)
    with pytest.raises(BusError, match="cannot listen there"):
        TcpListener("127.0.0.1:x")
