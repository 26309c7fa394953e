"""CAN: does the kernel speak it, which interfaces are there, and can there be a virtual one?"""

import os
import socket
from collections.abc import Callable
from pathlib import Path

from kurt2rt.doctor.finding import Finding, Status
from kurt2rt.doctor.sysfs import attribute

NET_FOLDER = Path("/sys/class/net")
MODULES_FOLDER = Path("/lib/modules", os.uname().release)
BIT_RATE_BIT_S = 1_000_000
"""KURT2's, as in config/robots/kurt2.yaml; held here too, for a doctor must not fail over a file that is broken."""

_ARPHRD_CAN = 280
_IFF_UP = 1
_OTHER_KERNEL = (
    "boot a kernel with CAN (Debian: linux-image-amd64; Ubuntu: linux-modules-extra-$(uname -r)); simulation needs none"
)


def _open_can_socket() -> socket.socket:
    return socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)


def check_can_kernel(
    open_socket: Callable[[], socket.socket] = _open_can_socket, modules: Path = MODULES_FOLDER
) -> Finding:
    """Can a CAN socket be opened?"""
    try:
        open_socket().close()
    except (OSError, AttributeError) as error:  # AttributeError: a Python that was built without CAN
        what_to_do = "sudo modprobe -a can can_raw" if _offers("can-raw", modules) else _OTHER_KERNEL
        return Finding("CAN in the kernel", Status.MISSING, f"no AF_CAN socket ({error})", what_to_do)
    return Finding("CAN in the kernel", Status.OK, "AF_CAN sockets can be opened")


def check_can_interfaces(net: Path = NET_FOLDER) -> tuple[Finding, ...]:
    """Which CAN interfaces with hardware are there, and are they up? One finding each, or one that there is none."""
    interfaces = [each for each in _can_interfaces(net) if not _is_virtual(each)]
    if not interfaces:
        what_to_do = f"plug in the adapter, then: {_up('can0')}"
        return (Finding("CAN interface", Status.MISSING, f"none with hardware in {net}", what_to_do),)
    return tuple(_check_interface(each) for each in interfaces)


def check_vcan(net: Path = NET_FOLDER, modules: Path = MODULES_FOLDER) -> Finding:
    """Is there a virtual CAN interface? Only tests over the kernel's CAN want one."""
    interfaces = [each for each in _can_interfaces(net) if _is_virtual(each)]
    for each in interfaces:
        if _is_up(each):
            return Finding("virtual CAN", Status.OK, f"{each.name}, up")
    if interfaces:
        name = interfaces[0].name
        return Finding("virtual CAN", Status.WARNING, f"{name}, down", f"sudo ip link set {name} up")
    if not _offers("vcan", modules):
        return Finding("virtual CAN", Status.WARNING, f"no interface, no module vcan in {modules}", _OTHER_KERNEL)
    what_to_do = "sudo modprobe vcan && sudo ip link add dev vcan0 type vcan && sudo ip link set vcan0 up"
    return Finding("virtual CAN", Status.WARNING, "no interface, but the module vcan is there", what_to_do)


def _check_interface(interface: Path) -> Finding:
    subject = f"CAN interface {interface.name}"
    if not _is_up(interface):
        return Finding(subject, Status.WARNING, "down", _up(interface.name))
    if attribute(interface / "carrier") == "0":
        what_to_do = f"check cable, terminators and bit rate; sudo ip link set {interface.name} down; "
        return Finding(subject, Status.WARNING, "up, but off the bus", what_to_do + _up(interface.name))
    return Finding(subject, Status.OK, "up")


def _can_interfaces(net: Path) -> list[Path]:
    return [each for each in sorted(net.glob("*")) if attribute(each / "type") == str(_ARPHRD_CAN)]


def _is_virtual(interface: Path) -> bool:
    # Behind slcan there is a serial line, which sysfs shows as no device.
    return not (interface / "device").exists() and not interface.name.startswith("slcan")


def _is_up(interface: Path) -> bool:
    return bool(int(attribute(interface / "flags") or "0", 16) & _IFF_UP)


def _up(name: str) -> str:
    # The bit rate of a serial-line adapter is slcand's to set; ip refuses it. And ip takes `up` only before `type`.
    bit_rate = "" if name.startswith("slcan") else f" type can bitrate {BIT_RATE_BIT_S}"
    return f"sudo ip link set {name} up{bit_rate}"


def _offers(module: str, modules: Path) -> bool:
    """Does the running kernel have this module, loadable or built in?"""
    lists = [modules / "modules.dep", modules / "modules.builtin"]
    return any(f"/{module}.ko" in each.read_text(encoding="utf-8") for each in lists if each.is_file())
