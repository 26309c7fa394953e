"""Order: a command to run in a machine, and the machine that it needs."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Order:
    """One command and the machine it is to run in."""

    command: tuple[str, ...]
    interfaces: tuple[str, ...] = ("vcan0",)
    """Virtual CAN interfaces that are up when the command starts."""
    echo: bool = True
    """Frames come back to this machine's own listeners by the driver, after the queue discipline, as with an adapter.
    Without it they take a short cut: `tc` delays nothing, and a sender hears at once what the bus has yet to carry."""
    limit_s: int = 900
    """Time limit of the command: seconds of the machine, in simulated time simulated seconds."""
    shared: tuple[Path, ...] = ()
    """Directories that the command may write to, besides the current one. The rest of what it writes is lost (uml)."""
    memory_mib: int = 1024
    """Memory of a uml machine; it takes what is touched."""
    cpu: int | None = None
    """Processor for a uml machine; None takes the least busy one."""
    kernel: Path | None = None
    """A User-Mode Linux kernel with CAN built in; None takes Debian's with its modules."""
    kernel_arguments: tuple[str, ...] = ()
    systemd: bool = False
    """True makes systemd the first process of a uml machine, as on a robot's computer; else a minimal script is."""
