"""CAN log with a writer that may fail, in step with simulated time."""

import threading
import time
from collections.abc import Iterator, Sequence

import can

from kurt2rt.runs.recording.can_log import CanLog
from tests.faults.fault import FaultInjection

_PERIOD_S = 0.1
_LOOK_S = 0.0002
_ROOM_FRAMES = 500


class _FaultyWriter:
    """Destination of the log (kurt2rt.runs.recording.can_log.FrameWriter)."""

    def __init__(self, injection: FaultInjection) -> None:
        self.waits_until_s: float | None = None
        self.is_over = False
        self._injection = injection

    def write(self, frames: Sequence[can.Message]) -> None:
        """Write frames under the fault. Raises OSError, AttributeError."""
        fault, simulated = self._injection.acting_on("recorder"), self._injection.time
        if fault is None:
            return
        match fault.kind:
            case "off" | "intermittent":
                raise OSError("Input/output error")
            case "garbage":
                raise AttributeError("'NoneType' object has no attribute 'write'")
            case "wrong":
                for frame in frames:
                    frame.arbitration_id, frame.data = 0, bytearray(8)
            case "stuck" | "slow" | "delayed":
                self.waits_until_s = fault.end_s if fault.kind == "stuck" else simulated.now_s() + fault.delay_s
                while simulated.now_s() < self.waits_until_s and not self.is_over:
                    time.sleep(_LOOK_S)
                self.waits_until_s = None

    def close(self) -> None:
        """Do nothing: nothing was opened."""


class FaultyCanLog:
    """CAN log (hal.tap.Tap) whose thread writes every 0.1 s of simulated time unless it still blocks.

    off, garbage, intermittent: errors. stuck: a write blocks, with room for half a second. wrong: the writer changes
    its frames. slow, delayed: each write takes long.
    """

    def __init__(self, injection: FaultInjection) -> None:
        self._writer = _FaultyWriter(injection)
        self._simulated = injection.time
        self._log = CanLog(self._writer, "a drill's", "sim", _ROOM_FRAMES)
        self._noted = 0
        self._thread: threading.Thread | None = None
        self._plan()

    def on_rx(self, frame: can.Message, age_s: float) -> None:
        self._noted += 1
        self._log.on_rx(frame, age_s)

    def on_tx(self, frame: can.Message) -> None:
        self._noted += 1
        self._log.on_tx(frame)

    @property
    def lost(self) -> int:
        """Number of lost frames by the log's own count."""
        return self._log.lost

    def close(self) -> Iterator[str]:
        """End the thread, write the rest and yield a complaint if the log's own counts do not add up."""
        self._writer.is_over = True
        if self._thread is not None:
            self._thread.join()
        self._log.write_waiting()
        if self._log.written + self._log.lost != self._noted:
            yield f"{self._noted} frames passed, {self._log.written} were written and {self._log.lost} lost"

    def _plan(self) -> None:
        self._simulated.at(self._simulated.now_s() + _PERIOD_S, self._write)

    def _write(self) -> None:
        if self._writer.is_over:
            return
        self._plan()
        self._keep_in_step()
        if self._thread is None:
            self._thread = threading.Thread(target=self._log.write_waiting, name="drill's CAN log", daemon=True)
            self._thread.start()
            self._keep_in_step()

    def _keep_in_step(self) -> None:
        """Wait in real time until the writer is idle, or blocks beyond this simulated time."""
        while self._thread is not None:
            waits_until_s = self._writer.waits_until_s
            if waits_until_s is not None and self._simulated.now_s() < waits_until_s:
                return
            self._thread.join(_LOOK_S)
            if not self._thread.is_alive():
                self._thread = None
