"""Debian's can-utils, as a person at a terminal uses them."""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from config import CONFIG_DIR

_TOO_LONG_S = 120.0


class Line(NamedTuple):
    """One line of candump's log."""

    time_s: float
    frame_id: int
    data: bytes


def candump(bus: str, frames: int) -> str:
    """So many frames of a bus, as candump -L prints them."""
    return _said("candump", "-L", "-r", "8000000", "-n", str(frames), bus)


def lines_of(log: str) -> list[Line]:
    """Return the lines of a candump log."""
    lines = []
    for line in log.splitlines():
        stamp, _, frame = line.split()[:3]
        frame_id, _, data = frame.partition("#")
        lines.append(Line(float(stamp[1:-1]), int(frame_id, 16), bytes.fromhex(data)))
    return lines


def cansend(bus: str, frame: str) -> None:
    """Send one frame."""
    _said("cansend", bus, frame)


@contextmanager
def doing(*words: str) -> Iterator["subprocess.Popen[bytes]"]:
    """Run a program in the background; end it at the end."""
    with subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL) as process:
        try:
            yield process
        finally:
            process.kill()


def cantools_decode(log: str) -> str:
    """Return the output of `cantools decode` for a candump log, with the project's database."""
    dbc: Path = CONFIG_DIR / "can" / "kurt2.dbc"
    return _said(sys.executable, "-m", "cantools", "decode", "--single-line", str(dbc), typed=log)


def _said(*words: str, typed: str = "") -> str:
    return subprocess.run(words, check=True, input=typed, stdout=subprocess.PIPE, text=True, timeout=_TOO_LONG_S).stdout
