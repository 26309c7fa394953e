"""Writer of CAN frames in the file formats of other tools."""

from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

import can

from kurt2rt.platform.yield_gil import yield_gil
from kurt2rt.runs.recording.recording_error import RecordingError

ENDINGS = (".log", ".asc", ".blf", ".csv", ".trc", ".mf4")
"""Suffixes of candump, Vector ASC and BLF, CSV, PEAK trace and ASAM MF4.

python-can's SQLite is left out: its queue is unbounded.
"""

_ERROR_FLAG = 0x2000_0000
"""CAN_ERR_FLAG of linux/can.h."""
_MAX_SAME_NAME = 1000


class FrameWriter(Protocol):
    """Destination of a CAN log. It may block and raise any error, because it runs in the log's thread."""

    def write(self, frames: Sequence[can.Message]) -> None:
        """Write frames with time stamps in s since 1970, and flush if the format can."""
        ...

    def close(self) -> None:
        """Complete the log and close it; call it once."""
        ...


class LogFile:
    """New file in one of python-can's formats (FrameWriter)."""

    def __init__(self, path: Path) -> None:
        """Create the file, numbered if the name is taken. Raises RecordingError, OSError."""
        if path.suffix not in ENDINGS:
            raise RecordingError(
                "no known kind of CAN log", where=path, do=f"give a name that ends in {', '.join(ENDINGS)}"
            )
        self.path = _create_numbered(path)
        """Path of the file."""
        try:
            self._writer = can.Logger(self.path)
        except NotImplementedError as error:
            self.path.unlink()
            raise RecordingError(
                "needs the package asammdf", where=path, do="install it, or give a name in .blf"
            ) from error
        self._is_candump = path.suffix == ".log"

    def write(self, frames: Sequence[can.Message]) -> None:
        """Write frames in the file's format (FrameWriter). Raises OSError."""
        for frame in yield_gil(frames):
            self._writer.on_message_received(_with_error_flag(frame) if self._is_candump else frame)
        flush = getattr(getattr(self._writer, "file", None), "flush", None)
        if flush is not None:
            flush()

    def close(self) -> None:
        """Complete the file: BLF and MF4 are readable only then. Raises OSError."""
        self._writer.stop()


def _create_numbered(path: Path) -> Path:
    # A supervisor starts the same command line again after a crash, and the log of the crash is the one to keep.
    for number in range(1, _MAX_SAME_NAME):
        numbered = path if number == 1 else path.with_stem(f"{path.stem}-{number}")
        try:
            numbered.touch(exist_ok=False)
        except FileExistsError:
            continue
        return numbered
    raise RecordingError("so many logs of this name are there already", where=path, do="move them away")


def _with_error_flag(frame: can.Message) -> can.Message:
    """Return an error frame with its error class in the id, which python-can's line omits: 20000040# is bus-off."""
    if not frame.is_error_frame:
        return frame
    return can.Message(
        timestamp=frame.timestamp,
        arbitration_id=_ERROR_FLAG | frame.arbitration_id,
        is_extended_id=True,
        is_rx=frame.is_rx,
        channel=frame.channel,
        data=frame.data,
        dlc=frame.dlc,
    )
