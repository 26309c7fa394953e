"""CAN log with a writer that may fail, written in line, as far as simulated time has gone."""

from collections.abc import Iterator, Sequence

import can

from hal.bus import CanBus
from kurt2rt.runs.recording.can_log import CanLog
from tests.stories.fault import FaultInjection

_PERIOD_S = 0.1
_ROOM_FRAMES = 500


class _FaultyWriter:
    """Destination of the log (kurt2rt.runs.recording.can_log.FrameWriter)."""

    def __init__(self, injection: FaultInjection) -> None:
        self._injection = injection

    def write(self, frames: Sequence[can.Message]) -> None:
        """Write frames under the fault. Raises OSError, AttributeError."""
        fault = self._injection.acting_on("recorder")
        match None if fault is None else fault.kind:
            case "off" | "intermittent":
                raise OSError("Input/output error")
            case "garbage":
                raise AttributeError("'NoneType' object has no attribute 'write'")
            case "wrong":
                for frame in frames:
                    frame.arbitration_id, frame.data = 0, bytearray(8)

    def close(self) -> None:
        """Do nothing: nothing was opened."""


class FaultyCanLog(CanLog):
    """CAN log that is written every 0.1 s of simulated time unless its writer blocks.

    off, garbage, intermittent: errors. stuck: a write blocks, with room for half a second. wrong: the writer changes
    its frames. slow, delayed: each write takes long.
    """

    def __init__(self, injection: FaultInjection, bus: CanBus) -> None:
        super().__init__(_FaultyWriter(injection), "a drill's", "sim", _ROOM_FRAMES)
        self._injection, self._time, self._bus = injection, injection.time, bus
        bus.tap = self
        self._noted = 0
        self._is_over = False
        self._plan()

    def on_rx(self, frame: can.Message, age_s: float) -> None:
        self._noted += 1
        super().on_rx(frame, age_s)

    def on_tx(self, frame: can.Message) -> None:
        self._noted += 1
        super().on_tx(frame)

    def finish(self) -> Iterator[str]:
        """Leave the bus, write the rest, and yield a complaint if the log's own counts do not add up."""
        self._is_over, self._bus.tap = True, None
        self.write_waiting()
        if self.written + self.lost != self._noted:
            yield f"{self._noted} frames passed, {self.written} were written and {self.lost} lost"

    def _plan(self) -> None:
        now_s, fault = self._time.now_s(), self._injection.acting_on("recorder")
        after_s = _PERIOD_S
        if fault is not None and fault.kind in ("stuck", "slow", "delayed"):
            after_s = fault.end_s - now_s if fault.kind == "stuck" else fault.delay_s
        self._time.at(now_s + after_s, self._write)

    def _write(self) -> None:
        if not self._is_over:
            self.write_waiting()
            self._plan()
