"""CAN: the kernel of this machine, and trees like /sys/class/net of other machines."""

import socket
from pathlib import Path

import pytest

from kurt2rt.checks.doctor.can_bus import check_can_interfaces, check_can_kernel, check_vcan
from kurt2rt.checks.doctor.check_result import CheckStatus, FindingCode

UP = "0x400c1"
DOWN = "0x400c0"


class Net:
    """A tree like /sys/class/net."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.folder.mkdir()

    def add(self, name: str, *, kind: int = 280, flags: str = UP, device: bool = True, carrier: str = "1") -> None:
        interface = self.folder / name
        interface.mkdir()
        (interface / "type").write_text(f"{kind}\n")
        (interface / "flags").write_text(f"{flags}\n")
        if device:
            (interface / "device").mkdir()
        if flags == UP:  # of an interface that is down the kernel refuses to tell it
            (interface / "carrier").write_text(f"{carrier}\n")


@pytest.fixture
def net(tmp_path: Path) -> Net:
    net = Net(tmp_path / "net")
    net.add("lo", kind=772, device=False)
    net.add("eth0", kind=1)
    (net.folder / "bonding_masters").write_text("")  # a file among the folders, as the kernel has it
    return net


@pytest.fixture
def modules(tmp_path: Path) -> Path:
    """Return a tree like /lib/modules/6.1.0: can-raw can be loaded, vcan is built in."""
    folder = tmp_path / "modules"
    folder.mkdir()
    (folder / "modules.dep").write_text("kernel/net/can/can-raw.ko.xz: kernel/net/can/can.ko.xz\n")
    (folder / "modules.builtin").write_text("kernel/drivers/net/can/vcan.ko\n")
    return folder


def no_can() -> socket.socket:
    raise OSError(97, "Address family not supported by protocol")


def test_the_socket_that_was_tried_is_closed_again() -> None:
    tried = socket.socket()
    assert check_can_kernel(lambda: tried).status is CheckStatus.OK
    assert tried.fileno() == -1


def test_check_can_kernel_without_can_still_allows_a_run(tmp_path: Path) -> None:
    finding = check_can_kernel(no_can, tmp_path)
    assert finding.status is CheckStatus.MISSING
    assert finding.code is FindingCode.CAN_MISSING
    assert not finding.forbids_run


def test_each_interface_with_hardware_is_looked_at(net: Net) -> None:
    net.add("can0")
    net.add("can1", flags=DOWN)
    net.add("vcan0", device=False)
    up, down = check_can_interfaces(net.folder)
    assert (up.code, up.status, up.values["name"]) == (FindingCode.CAN_INTERFACE, CheckStatus.OK, "can0")
    assert (down.code, down.status) == (FindingCode.CAN_INTERFACE_DOWN, CheckStatus.WARNING)
    assert down.values == {"name": "can1", "up": "sudo ip link set can1 up type can bitrate 1000000"}


def test_an_interface_that_went_off_the_bus_points_to_the_wiring(net: Net) -> None:
    net.add("can0", carrier="0")
    (finding,) = check_can_interfaces(net.folder)
    assert finding.status is CheckStatus.WARNING
    assert finding.code is FindingCode.CAN_INTERFACE_OFF_BUS


def test_a_virtual_interface_that_is_up_will_do(net: Net) -> None:
    net.add("vcan0", flags=DOWN, device=False)
    net.add("vcan1", device=False)
    finding = check_vcan(net.folder)
    assert (finding.code, finding.values) == (FindingCode.VCAN, {"name": "vcan1"})


def test_a_virtual_interface_that_is_down_is_to_be_set_up(net: Net) -> None:
    net.add("vcan0", flags=DOWN, device=False)
    finding = check_vcan(net.folder)
    assert finding.status is CheckStatus.WARNING
    assert (finding.code, finding.values) == (FindingCode.VCAN_DOWN, {"name": "vcan0"})


def test_a_module_that_is_there_can_make_a_virtual_interface(net: Net, modules: Path) -> None:
    net.add("can0")
    assert check_vcan(net.folder, modules).code is FindingCode.VCAN_NONE
