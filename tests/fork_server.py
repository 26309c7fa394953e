"""Process that forks the programs of stories, with all their imports loaded: `python -m tests.fork_server`.

A fresh interpreter takes more than a second of a processor for these imports, in each program. A fork
runs the same as `python -m`, and ends as an interpreter ends.

One serves a whole test session, all its workers: its first argument is the address (Linux's abstract kind), its second
the descriptor of a pipe from the process that started it; it ends with that process.
"""

import atexit
import contextlib
import gc
import io
import json
import os
import runpy
import select
import signal
import socket
import struct
import sys
from importlib import import_module
from typing import NamedTuple

import pytest

ADDRESS = "KURT2RT_NURSERY"
"""The variable of the environment in which a session's workers find the address."""
NUMBER = struct.Struct("=q")
"""Both numbers that are told of a program: its process id, and at its end the exit code."""
DESCRIPTORS = 4
"""Descriptors of each order: standard input, output and errors of the program, and the pipe for both numbers."""
_MODULES = (
    *("aiocoap.oscore", "aiocoap.transports.udp6", "anyio._backends._asyncio", "anyio.streams.tls"),
    *("kurt2rt.cli.commission", "kurt2rt.cli.main", "kurt2rt.cli.run", "kurt2rt.cli.sim", "simbridge.sim_console"),
    *("kurt2rt.cli.teach", "behaviors.metrics.laps", "kurt2rt.teacher.page.server", "kurt2rt.service.serve"),
    *("simbridge.realtime", "numpy.ma", "rich._emoji_codes", "simbridge.realtime", "typer._adapters", "uvicorn"),
)


class Order(NamedTuple):
    """A program to be run."""

    module: str
    words: list[str]
    folder: str
    environment: dict[str, str]


def preload() -> None:
    """Import what programs need, and set it aside for all of them."""
    for name in _MODULES:
        import_module(name)
    from hal.codec import load_codec
    from hal.robot_settings import load_robot
    from kurt2rt.core.task_settings import load_task
    from tests.patient_shutdown import extend_deadlines

    extend_deadlines(pytest.MonkeyPatch())
    load_codec()  # and remembers it
    load_robot()
    load_task("wall_following")  # with the code of its judges
    # A collection in a program would write into all that it shares with the others, and so copy it.
    gc.collect()
    gc.freeze()


def _receive(caller: socket.socket) -> tuple[Order, list[int]]:
    data, descriptors, _, _ = socket.recv_fds(caller, 1 << 16, DESCRIPTORS)
    while more := caller.recv(1 << 16):
        data += more
    return Order(*json.loads(data)), descriptors


def _bury() -> None:
    """Hear of those that ended meanwhile, so that what they took of a processor is counted."""
    with contextlib.suppress(ChildProcessError):
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass


def _born(descriptors: list[int]) -> bool:
    """Fork the program and a process that waits for its end and reports it; return True in the program."""
    told = descriptors[3]
    if os.fork():
        for each in descriptors:
            os.close(each)
        return False
    program = os.fork()
    if program == 0:
        return True
    try:
        for each in descriptors[:3]:
            os.close(each)
        os.write(told, NUMBER.pack(program))
        _, status = os.waitpid(program, 0)
        os.write(told, NUMBER.pack(os.waitstatus_to_exitcode(status)))
    finally:
        os._exit(0)  # it is none of those who serve


def _become(order: Order, descriptors: list[int]) -> None:
    for number, each in enumerate(descriptors[:3]):
        os.dup2(each, number)
    for each in descriptors:
        os.close(each)
    _open_streams()
    signal.signal(signal.SIGINT, signal.default_int_handler)
    os.environ.clear()
    os.environ.update(order.environment)
    os.chdir(order.folder)
    sys.path[0] = order.folder
    sys.argv = [order.module, *order.words]
    sys.modules.pop(order.module, None)  # it is run as the main module


def _open_streams() -> None:
    """Open Python's streams again: those of the fork server remember whether its own could be sought in."""
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        before: io.TextIOWrapper = getattr(sys, name)
        raw = open(number, "wb" if number else "rb", buffering=0 if number else -1, closefd=False)  # noqa: SIM115
        stream = io.TextIOWrapper(raw, before.encoding, before.errors, write_through=True)
        setattr(sys, name, stream)
        setattr(sys, f"__{name}__", stream)


def serve(address: str, parent: int) -> Order | None:
    """Fork what is ordered until the parent is gone; in a fork the order, which is to be carried out now."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(f"\0{address}")
        listener.listen(64)
        os.write(1, b"\n")
        loaded = False
        while parent not in select.select([listener.fileno(), parent], [], [])[0]:
            _bury()
            caller, _ = listener.accept()
            with caller:
                order, descriptors = _receive(caller)
            if not loaded:  # not before: most of those who start tests run few programs
                preload()
                loaded = True
            if _born(descriptors):
                listener.close()
                os.close(parent)
                _become(order, descriptors)
                return order
    _bury()
    return None


class _Leave:
    """The last that an interpreter does at its end; it then need not tear down what it shares with the fork server."""

    def __init__(self) -> None:
        self.code: int | None = None
        atexit.register(self)

    def __call__(self) -> None:
        if self.code is not None:
            for each in (sys.stdout, sys.stderr):
                each.flush()
            os._exit(self.code)


def _carry_out(order: Order) -> None:
    leave = _Leave()
    try:
        runpy.run_module(order.module, run_name="__main__", alter_sys=True)
    except SystemExit as end:
        if end.code is None or isinstance(end.code, int):
            leave.code = (end.code or 0) & 0xFF
        raise
    leave.code = 0


if __name__ == "__main__":
    _order = serve(sys.argv[1], int(sys.argv[2]))
    if _order is not None:
        _carry_out(_order)
