"""Bus by name that carries a simulated robot's frames, so that other programs hear them."""

from pathlib import Path

from config.errors import UserError
from hal.bus import open_bus
from hal.kurt2_settings import Kurt2Settings

NET_FOLDER = Path("/sys/class/net")
_ARPHRD_CAN = "280"
_IFF_UP = 0x1
_KINDS = "a vcan interface such as vcan0, shared:NAME or virtual:NAME"


class NoVcanError(UserError):
    """Interface vcan0, or the one named instead, that the kernel does not have, or that is down."""


def require_bus(name: str, settings: Kurt2Settings, net: Path = NET_FOLDER) -> None:
    """Check a bus for a simulated robot; listens to it for 0.1 s. `net`: folder of the kernel's interfaces.

    Raises NoVcanError if there is no such interface or it is down, UserError if it is real or a robot sends on it.
    """
    if ":" not in name:
        _require_vcan(name, net)
    # Late import: the simulator is an extra.
    from simbridge.links import require_free_bus

    bus = open_bus(name)
    try:
        require_free_bus(settings, bus)
    finally:
        bus.shutdown()


def _require_vcan(name: str, net: Path) -> None:
    """Raise UserError for any other interface: a real robot would execute the commands for the simulated one."""
    interface = net / name
    # The name has to tell as well: an adapter on a serial line (slcan) has no device either.
    if not name.startswith("vcan") or (interface / "device").exists():
        raise UserError(f"is not a virtual CAN interface (allowed {_KINDS})", where=f"bus {name!r}")
    try:
        kind = (interface / "type").read_text(encoding="ascii").strip()
        flags = int((interface / "flags").read_text(encoding="ascii"), base=16)
    except (OSError, ValueError) as error:
        up = f"sudo modprobe vcan && sudo ip link add dev {name} type vcan && sudo ip link set {name} up"
        raise NoVcanError("the kernel has no such interface", where=f"bus {name!r}", do=up) from error
    if kind != _ARPHRD_CAN:
        raise UserError("is a network interface, but not of CAN", where=f"bus {name!r}", do=f"give {_KINDS}")
    if not flags & _IFF_UP:
        raise NoVcanError("the interface is down", where=f"bus {name!r}", do=f"sudo ip link set {name} up")
