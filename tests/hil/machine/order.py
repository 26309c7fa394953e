"""Order: a command to run in a machine, and the machine that it needs."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Order:
    """One command and the machine it is to run in."""

    command: tuple[str, ...]
    interfaces: tuple[str, ...] = ("vcan0",)
    """Virtual CAN interfaces that are up when the command starts."""
    limit_s: int = 900
    """Time limit of the command: seconds of the machine, in simulated time simulated seconds."""
    shared: tuple[Path, ...] = ()
    """Directories that the command may write to, besides the current one. The rest of what it writes is lost (uml)."""
    kernel: Path | None = None
    """A User-Mode Linux kernel with CAN built in; None takes Debian's with its modules."""
    kernel_arguments: tuple[str, ...] = ()
    systemd: bool = False
    """True makes systemd the first process of a uml machine, as on a robot's computer; else a minimal script is."""
