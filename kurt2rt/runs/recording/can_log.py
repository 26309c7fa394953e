"""The CAN log: what the robot's program hears and sends, written beside it and never at its cost."""

import time
from pathlib import Path
from types import TracebackType
from typing import NamedTuple, Self

import can

from kurt2rt.runs.recording.frame_writer import FrameWriter, LogFile
from kurt2rt.runs.recording.writer_thread import WriterThread

CAPACITY_FRAMES = 20_000
"""That wait for the writer: some 25 s of a disk that does not answer, 5 MB."""
_PATIENCE_S = 2.0
_CHANNEL = "can0"
"""Name of a bus in the file that is no interface of the kernel: a log of it can be played on one."""


class _Noted(NamedTuple):
    """A frame on its way to the writer."""

    time_s: float
    is_rx: bool
    frame: can.Message


class CanLog:
    """Looks on at a bus (hal.tap.Tap) and writes what passes in a thread of its own, ten times a second.

    Noting a frame takes about a microsecond, never waits and never raises. Frames that the writer does not keep up
    with, or fails to write, are lost and counted; it goes on with the next ones.
    """

    def __init__(self, writer: FrameWriter, name: str, bus: str, capacity_frames: int = CAPACITY_FRAMES) -> None:
        """Owns the writer from now on. `name`: of the file, for messages; `bus`: as hal.bus.open_bus takes it."""
        self.name = name
        self.written = 0
        """Frames so far."""
        self._writer = writer
        self._channel = _CHANNEL if ":" in bus or bus == "sim" else bus
        self._thread = WriterThread[_Noted]("CAN log", capacity_frames, self._run)
        self._failure = ""
        self._not_written = 0
        # The wall clock may be set meanwhile; the stamps go on evenly.
        self._began_at_s = time.time() - time.monotonic()

    @property
    def lost(self) -> int:
        """Frames that are not in the file: the writer was too slow, or failed."""
        return self._thread.overruns + self._not_written

    @property
    def trouble(self) -> str:
        """What is wrong with the log, in a line for the user; empty while every frame is kept."""
        wrong = [self._failure] if self._failure else []
        wrong += [f"{self.lost} frames lost"] if self.lost else []
        return f"CAN log {self.name}: {', '.join(wrong)}" if wrong else ""

    def on_rx(self, frame: can.Message, age_s: float) -> None:
        """A frame that came in."""
        self._thread.submit(_Noted(self._began_at_s + time.monotonic() - age_s, True, frame))

    def on_tx(self, frame: can.Message) -> None:
        """A frame that went out."""
        self._thread.submit(_Noted(self._began_at_s + time.monotonic(), False, frame))

    def write_waiting(self) -> None:
        """Write all that waits; what the thread does again and again, and a run in simulated time by itself."""
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
        """Begin to write; once only."""
        self._thread.start()

    def close(self, patience_s: float = _PATIENCE_S) -> None:
        """Write the rest and close the file; gives a writer that hangs up after a while. `trouble` tells what came."""
        if not self._thread.stop(patience_s):
            self._failure = "the disk does not answer; the end is missing"

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
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
    """A log in a new file; its ending says the format. Raises RecordingError, OSError."""
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
