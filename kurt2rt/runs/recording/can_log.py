"""CAN log, written by its own thread so that it never delays the control loop."""

import time
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple, Protocol, Self

import can

from kurt2rt.platform.yield_gil import yield_gil
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.recording.writer_thread import WriterThread

CAPACITY_FRAMES = 20_000
"""Most frames that wait for the writer: about 25 s of a disk that does not answer, 5 MB."""
_PATIENCE_S = 2.0
_CHANNEL = "can0"
"""Channel name in the file for a bus that is no kernel interface, so that canplayer accepts the log."""


ENDINGS = (".log", ".asc", ".blf", ".csv", ".trc")
"""Suffixes of candump, Vector ASC and BLF, CSV and PEAK trace.

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
    """Log file of CAN frames in a format of python-can, chosen by its ending (FrameWriter)."""

    def __init__(self, path: Path) -> None:
        """Create the file, numbered if the name is taken. Raises RecordingError, OSError."""
        if path.suffix not in ENDINGS:
            raise RecordingError(
                "no known kind of CAN log", where=path, do=f"give a name that ends in {', '.join(ENDINGS)}"
            )
        self.path = _create_numbered(path)
        """Path of the file."""
        self._writer = can.Logger(self.path)
        self._is_candump = path.suffix == ".log"

    def write(self, frames: Sequence[can.Message]) -> None:
        """Write frames in the file's format (FrameWriter). Raises OSError."""
        for frame in yield_gil(frames):
            self._writer.on_message_received(_with_error_flag(frame) if self._is_candump else frame)
        flush = getattr(getattr(self._writer, "file", None), "flush", None)
        if flush is not None:
            flush()

    def close(self) -> None:
        """Complete the file: BLF is readable only then. Raises OSError."""
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
    raise RecordingError("too many logs have this name already", where=path, do="move them away")


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


class _Noted(NamedTuple):
    """Frame on its way to the writer."""

    time_s: float
    is_rx: bool
    frame: can.Message


class CanLog:
    """Bus observer (hal.tap.Tap) that writes the traffic ten times a second in its own thread.

    Noting a frame takes about 1 us, never waits and never raises. Frames that the writer cannot keep up with, or fails
    to write, are lost and counted; later frames are written again.
    """

    def __init__(self, writer: FrameWriter, name: str, bus: str, capacity_frames: int = CAPACITY_FRAMES) -> None:
        """Take ownership of the writer.

        `name`: of the file, for messages. `bus`: as for hal.bus.open_bus.
        """
        self.name = name
        self.written = 0
        """Frames written so far."""
        self._writer = writer
        self._channel = _CHANNEL if ":" in bus or bus == "sim" else bus
        self._thread = WriterThread[_Noted]("CAN log", capacity_frames, self._run)
        self._failure = ""
        self._not_written = 0
        # The wall clock may be set meanwhile; the stamps go on evenly.
        self._began_at_s = time.time() - time.monotonic()

    @property
    def lost(self) -> int:
        """Number of frames missing in the file: the writer was too slow or failed."""
        return self._thread.overruns + self._not_written

    @property
    def trouble(self) -> str:
        """Error of the log in one line; empty while every frame is written."""
        wrong = [self._failure] if self._failure else []
        wrong += [f"{self.lost} frames lost"] if self.lost else []
        return f"CAN log {self.name}: {', '.join(wrong)}" if wrong else ""

    def on_rx(self, frame: can.Message, age_s: float) -> None:
        """Note a received frame that the bus carried `age_s` seconds ago; never waits."""
        self._thread.submit(_Noted(self._began_at_s + time.monotonic() - age_s, True, frame))

    def on_tx(self, frame: can.Message) -> None:
        """Note a sent frame; never waits."""
        self._thread.submit(_Noted(self._began_at_s + time.monotonic(), False, frame))

    def write_waiting(self) -> None:
        """Write all waiting frames.

        The thread calls it periodically; a run in simulated time calls it itself.
        """
        noted = list(self._thread.pop_all())
        if not noted:
            return
        try:
            self._writer.write([_stamped(each, self._channel) for each in noted])
        except Exception as error:  # noqa: BLE001  # of whatever kind: it is counted and told, and the robot goes on
            self._failure = f"writing failed ({error})"
            self._not_written += len(noted)
        else:
            self._failure = ""
            self.written += len(noted)

    def start(self) -> None:
        """Start the thread; call it once."""
        self._thread.start()

    def close(self, patience_s: float = _PATIENCE_S) -> None:
        """Write the rest and close the file; give up after `patience_s`. `trouble` holds the error."""
        if not self._thread.stop(patience_s):
            self._failure = "the disk does not answer; the end is missing"

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _run(self) -> None:
        ended = False
        while not ended:
            ended = self._thread.wait_period()
            self.write_waiting()
        try:
            self._writer.close()
        except Exception as error:  # noqa: BLE001  # as above
            self._failure = f"closing failed ({error})"


def open_can_log(path: Path, bus: str) -> CanLog:
    """Open a log of the bus named `bus` in a new file, in the format of its suffix; not started yet.

    Raises RecordingError for an unknown suffix, OSError.
    """
    file = LogFile(path)
    return CanLog(file, str(file.path), bus)


def _stamped(noted: _Noted, channel: str) -> can.Message:
    # A copy: the guard sends the same object again and again.
    frame = noted.frame
    return can.Message(
        timestamp=noted.time_s,
        arbitration_id=frame.arbitration_id,
        is_extended_id=frame.is_extended_id,
        is_remote_frame=frame.is_remote_frame,
        is_error_frame=frame.is_error_frame,
        is_rx=noted.is_rx,
        channel=channel,
        dlc=frame.dlc,
        data=None if frame.is_remote_frame else frame.data,
    )
