"""Log of candump, frame by frame, with the kernel's stamps."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from hal.bus import CONTROL_ID
from hal.control import RawControl, SystemControl, decode_control
from hal.robot import STANDSTILL, WheelSpeeds
from tests.hal.helpers import CODEC, INFRARED_FRAMES, ROBOT

_LINE = re.compile(r"\((\d+)\.(\d{6})\) \S+ ([0-9A-F]{3})#([0-9A-F]*)")
_INFRARED_IDS = frozenset(CODEC.message(name).frame_id for name in INFRARED_FRAMES)
_ENCODER = CODEC.message("ENCODER")


class Told(NamedTuple):
    """A CONTROL frame; times are microseconds of the machine's wall clock."""

    at_us: int
    wheel_speeds: WheelSpeeds
    brakes: bool
    """Both sides, in the only mode that can."""

    @property
    def stops(self) -> bool:
        """The wheels are to stand."""
        return self.wheel_speeds == STANDSTILL


class Turned(NamedTuple):
    """An ENCODER frame."""

    at_us: int
    ticks: int
    """Sum of both sides, in either direction."""


@dataclass(frozen=True)
class Log:
    """One run, in the order of the bus."""

    told: tuple[Told, ...]
    infrared_us: tuple[int, ...]
    """Times of the readings."""
    turned: tuple[Turned, ...]


def read_log(path: Path) -> Log:
    """Read what `candump -L` wrote. Raises ValueError for a line that it did not."""
    told: list[Told] = []
    infrared_us: list[int] = []
    turned: list[Turned] = []
    for line in path.read_text(encoding="ascii").splitlines():
        match = _LINE.fullmatch(line)
        if match is None:
            raise ValueError(f"{path}: not a line of candump -L: {line}")
        at_us = 1_000_000 * int(match[1]) + int(match[2])
        frame_id, data = int(match[3], 16), bytes.fromhex(match[4])
        if frame_id == CONTROL_ID:
            told.append(_told(at_us, data))
        elif frame_id in _INFRARED_IDS:
            infrared_us.append(at_us)
        elif frame_id == _ENCODER.frame_id:
            left, right = _ENCODER.unpack(data)
            turned.append(Turned(at_us, abs(left) + abs(right)))
    return Log(tuple(told), tuple(infrared_us), tuple(turned))


def _told(at_us: int, data: bytes) -> Told:
    control = decode_control(data)
    assert not isinstance(control, SystemControl)
    brakes = isinstance(control, RawControl) and control.left.brake and control.right.brake
    return Told(at_us, control.wheel_speeds(ROBOT.motors), brakes)
