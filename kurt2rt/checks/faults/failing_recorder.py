"""CAN log with a faulty writer, synchronised with simulated time."""

import threading
import time
from collections.abc import Sequence

import can

from kurt2rt.checks.faults.complaint import Complaint, ComplaintCode, complaint
from kurt2rt.checks.faults.fault_rig import RigDisturbance, SimulatedTime
from kurt2rt.runs.recording.can_log import CanLog

_PERIOD_S = 0.1
_LOOK_S = 0.0002
_ROOM_FRAMES = 500


class _FailingWriter:
    """Faulty destination of the log (kurt2rt.runs.recording.frame_writer.FrameWriter)."""

    def __init__(self, simulated: SimulatedTime, disturbance: RigDisturbance) -> None:
        self.waits_until_s: float | None = None
        self.is_over = False
        self._simulated = simulated
        self._disturbance = disturbance

    def write(self, frames: Sequence[can.Message]) -> None:
        """Write frames under the fault. Raises OSError, AttributeError."""
        now_s = self._simulated.now_s()
        if self._disturbance.acts(now_s):
            match self._disturbance.kind:
                case "off" | "intermittent":
                    raise OSError("Input/output error")
                case "garbage":
                    raise AttributeError("'NoneType' object has no attribute 'write'")
                case "wrong":
                    for frame in frames:
                        frame.arbitration_id, frame.data = 0, bytearray(8)
                case "stuck":
                    self._wait(self._disturbance.end_s)
                case "slow" | "delayed":
                    self._wait(now_s + self._disturbance.delay_s)

    def close(self) -> None:
        """Do nothing."""

    def _wait(self, until_s: float) -> None:
        self.waits_until_s = until_s
        while self._simulated.now_s() < until_s and not self.is_over:
            time.sleep(_LOOK_S)
        self.waits_until_s = None


class FailingRecorder:
    """CAN log (hal.tap.Tap) whose thread writes every 0.1 s of simulated time unless it still blocks.

    off, garbage, intermittent: errors. stuck: a write blocks, with room for half a second. wrong: the writer changes
    its frames. slow, delayed: each write takes long.
    """

    def __init__(self, simulated: SimulatedTime, disturbance: RigDisturbance) -> None:
        self._writer = _FailingWriter(simulated, disturbance)
        self._simulated = simulated
        self._log = CanLog(self._writer, "a drill's", "sim", _ROOM_FRAMES)
        self._noted = 0
        self._thread: threading.Thread | None = None
        self._next_s = simulated.now_s()
        self._plan()

    def on_rx(self, frame: can.Message, age_s: float) -> None:
        """Note a received frame that the bus carried `age_s` seconds ago."""
        self._noted += 1
        self._log.on_rx(frame, age_s)

    def on_tx(self, frame: can.Message) -> None:
        """Note a frame that the driver sent."""
        self._noted += 1
        self._log.on_tx(frame)

    @property
    def lost(self) -> int:
        """Number of lost frames by the log's own count."""
        return self._log.lost

    def close(self) -> None:
        """End the fault and the thread, and write the rest."""
        self._writer.is_over = True
        if self._thread is not None:
            self._thread.join()
        self._log.write_waiting()

    def uncounted_frames(self) -> Complaint | None:
        """Compare the closed log's own count with the frames that passed; return None if it adds up."""
        if self._log.written + self._log.lost != self._noted:
            noted, written, lost = self._noted, self._log.written, self._log.lost
            return complaint(ComplaintCode.LOG_MISCOUNTED, noted=noted, written=written, lost=lost)
        return None

    def _plan(self) -> None:
        self._next_s += _PERIOD_S
        self._simulated.at(self._next_s, self._write)

    def _write(self) -> None:
        if self._writer.is_over:
            return
        self._plan()
        self._keep_in_step()
        if self._thread is None:
            self._thread = threading.Thread(target=self._log.write_waiting, name="drill's recorder", daemon=True)
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
