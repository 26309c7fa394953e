"""Checks of CAN: kernel support and interfaces with hardware."""

import os
import socket
from collections.abc import Callable
from pathlib import Path

from kurt2rt.checks.doctor.check_result import CheckResult, CheckStatus, FindingCode

NET_FOLDER = Path("/sys/class/net")
MODULES_FOLDER = Path("/lib/modules", os.uname().release)
BIT_RATE_BIT_S = 1_000_000
"""Bit rate of KURT2 as in config/robots/kurt2.yaml; repeated here so that a broken file does not stop the doctor."""

_ARPHRD_CAN = 280
_IFF_UP = 1


def _open_can_socket() -> socket.socket:
    return socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)


def check_can_kernel(
    open_socket: Callable[[], socket.socket] = _open_can_socket, modules: Path = MODULES_FOLDER
) -> CheckResult:
    """Check that a CAN socket can be opened; raises nothing.

    `modules`: folder of the kernel's modules, for the advice.
    """
    try:
        open_socket().close()
    except (OSError, AttributeError) as error:  # AttributeError: a Python that was built without CAN
        code = FindingCode.CAN_UNLOADED if _has_can_module(modules) else FindingCode.CAN_MISSING
        return CheckResult(code, CheckStatus.MISSING, {"error": str(error)})
    return CheckResult(FindingCode.CAN, CheckStatus.OK)


def check_can_interfaces(net: Path = NET_FOLDER) -> tuple[CheckResult, ...]:
    """Check each CAN interface with hardware; return one result each, or a single one if there is none.

    `net`: folder of the kernel's interfaces.
    """
    of_can = (each for each in sorted(net.glob("*")) if read_attribute(each / "type") == str(_ARPHRD_CAN))
    interfaces = [each for each in of_can if not _is_virtual(each)]
    if not interfaces:
        values = {"folder": str(net), "up": _up_command("can0")}
        return (CheckResult(FindingCode.CAN_INTERFACE_NONE, CheckStatus.MISSING, values),)
    return tuple(_check_interface(each) for each in interfaces)


def _check_interface(interface: Path) -> CheckResult:
    values = {"name": interface.name, "up": _up_command(interface.name)}
    if not int(read_attribute(interface / "flags") or "0", 16) & _IFF_UP:
        return CheckResult(FindingCode.CAN_INTERFACE_DOWN, CheckStatus.WARNING, values)
    if read_attribute(interface / "carrier") == "0":
        return CheckResult(FindingCode.CAN_INTERFACE_OFF_BUS, CheckStatus.WARNING, values)
    return CheckResult(FindingCode.CAN_INTERFACE, CheckStatus.OK, values)


def _is_virtual(interface: Path) -> bool:
    # Behind slcan there is a serial line, which sysfs shows as no device.
    return not (interface / "device").exists() and not interface.name.startswith("slcan")


def _up_command(name: str) -> str:
    # The bit rate of a serial-line adapter is slcand's to set; ip refuses it. And ip takes `up` only before `type`.
    bit_rate = "" if name.startswith("slcan") else f" type can bitrate {BIT_RATE_BIT_S}"
    return f"sudo ip link set {name} up{bit_rate}"


def _has_can_module(modules: Path) -> bool:
    """Return whether the running kernel can load CAN."""
    dependencies = modules / "modules.dep"
    return dependencies.is_file() and "/can-raw.ko" in dependencies.read_text(encoding="utf-8")


def read_attribute(path: Path) -> str:
    """Return the text of a file in /sys; empty if the kernel has none, as the carrier of an interface that is down."""
    try:
        return path.read_text(encoding="ascii").strip()
    except OSError:
        return ""
