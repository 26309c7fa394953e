"""`python -m tests.hil.machine COMMAND...`: run a command where the kernel's vcan0 is up."""

import argparse
import re
import signal
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from types import FrameType
from typing import NoReturn

from tests.hil.machine.native import find_native
from tests.hil.machine.order import Order
from tests.hil.machine.packages import need
from tests.hil.machine.small_kernel import small_kernel
from tests.hil.machine.task import NO_MACHINE
from tests.hil.machine.trouble import MachineError
from tests.hil.machine.uml import Uml

_TOOLS = {"ip": "iproute2", "tc": "iproute2", "candump": "can-utils"}
"""Tools that commands in the machine need, and their Debian packages."""
_SIMULATED_TIME = ("time-travel=inf-cpu", "time-travel-start=1700000000000000000")
"""The clock jumps to the next timer whenever all sleep, work takes no time, every run begins at the same instant."""
_INTERFACE_NAME = re.compile(r"[A-Za-z0-9_-]{1,15}")
_EPILOGUE = """
COMMAND's output and exit status are passed on; 124: time limit, 125: there is no machine. Its input is empty. In a uml
machine it is root, with one processor, loopback and the CAN interfaces, and writes that last in the current directory.
"""


class _Parser(argparse.ArgumentParser):
    """Ends with the runner's own exit status, which no command is to be mistaken for."""

    def error(self, message: str) -> NoReturn:
        self.exit(NO_MACHINE, f"machine: {message}\n{self.format_usage()}")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program; returns its exit status."""
    parser = _parser()
    options = parser.parse_args(arguments)
    command = options.command[1:] if options.command[:1] == ["--"] else options.command
    if not command and not options.check:
        parser.error("give a command")
    order = Order(
        command=tuple(command),
        interfaces=tuple(options.interface or ["vcan0"]),
        limit_s=options.limit,
        shared=tuple(options.share),
        kernel=options.kernel,
        kernel_arguments=tuple(options.kernel_argument),
        systemd=options.systemd,
    )
    try:
        if options.simulated_time:
            kernel = order.kernel or small_kernel(install=options.install)
            order = replace(order, kernel=kernel, kernel_arguments=(*_SIMULATED_TIME, *order.kernel_arguments))
        machine, run = _find(order, options.way, install=options.install)
        if options.check:
            print(machine)
            return 0
        return run()
    except (MachineError, OSError) as error:
        print(f"machine: {error}", file=sys.stderr, flush=True)
        return NO_MACHINE


def _find(order: Order, way: str, *, install: bool) -> tuple[str, Callable[[], int]]:
    """Return the name of the machine and the function that runs the order. Raises MachineError."""
    need(_TOOLS, install=install)
    why_not_native = ""
    if way == "native" or (way == "auto" and order.kernel is None and not order.systemd):
        try:
            native = find_native(order)
        except MachineError as error:
            if way == "native":
                raise
            why_not_native = f"{error}\n"
        else:
            return str(native), lambda: native.run(order)
    try:
        uml = Uml(order, install=install)
    except MachineError as error:
        raise MachineError(f"{why_not_native}{error}") from error
    return str(uml), uml.run


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="python -m tests.hil.machine", epilog=_EPILOGUE, description=__doc__)
    add = parser.add_argument
    add("--check", action="store_true", help="only say which way it goes")
    add("--way", choices=("auto", "native", "uml"), default="auto", help="auto: native where possible")
    add("--install", action="store_true", help="install missing Debian packages, as root or by sudo -n")
    add("--simulated-time", action="store_true", help="uml, on the small kernel, which is built when it is not there")
    add("--systemd", action="store_true", help="uml, with systemd as its first process, which runs COMMAND as a unit")
    add("--limit", type=_positive, default=900, metavar="S", help="seconds for COMMAND (%(default)s)")
    add("--interface", action="append", type=_interface, metavar="NAME", help="to bring up, again for more (vcan0)")
    add("--share", action="append", type=_directory, default=[], metavar="DIR", help="that COMMAND may write to (uml)")
    add("--kernel", type=Path, metavar="FILE", help="a uml kernel with CAN built in (Debian's, with modules)")
    add("--kernel-argument", action="append", default=[], metavar="WORD", help="again for more (uml)")
    add("command", nargs=argparse.REMAINDER, metavar="COMMAND")
    return parser


def _positive(text: str) -> int:
    if not text.isascii() or not text.isdigit() or int(text) == 0:
        raise argparse.ArgumentTypeError(f"{text}: give a whole number above 0")
    return int(text)


def _interface(text: str) -> str:
    if not _INTERFACE_NAME.fullmatch(text):
        raise argparse.ArgumentTypeError(f"{text}: no name for a network interface")
    return text


def _directory(text: str) -> Path:
    path = Path(text).resolve()
    if not path.is_dir():
        raise argparse.ArgumentTypeError(f"{text}: no such directory")
    return path


def _end(number: int, _: FrameType | None) -> NoReturn:
    sys.exit(128 + number)


if __name__ == "__main__":
    for signal_number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(signal_number, _end)
    sys.exit(main())
