"""Playing streams: a real guard, a real watchdog and a real CanBus live through them, and all that goes out is kept."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import can
import numpy as np
from numpy.typing import NDArray

from hal.bus import CanBus
from hal.frame import Frame
from hal.guard import Guard
from hal.guard_reason import GuardReason
from hal.kurt2_settings import Kurt2Settings
from hal.robot import GuardResult, SensorReadings, WheelSpeeds
from hal.watchdog import Watchdog
from tests.hal.helpers import guard_on
from tests.hal.streams import Bytes, Flags, Floats, Streams

FIRST, AGAIN, SIGNAL = GuardReason.SERVICE_ENDS, GuardReason.RUN_OVER, GuardReason.PROGRAM_WAITS
"""Reasons of the stops in a stream."""

MakeGuard = Callable[[Kurt2Settings, CanBus], Guard]


class SlowBus:
    """A bus end that can refuse frames, hold back confirmations, and be interrupted by a signal while it sends."""

    def __init__(self, *, receives_own_frames: bool) -> None:
        self.receives_own_frames = receives_own_frames
        self.overruns = 0
        self.refuses = False
        self.interrupt: Callable[[], None] | None = None
        self.attempts: list[can.Message] = []
        """Frames that were to go out."""
        self.refused: list[int] = []
        """Which of them did not."""
        self.waiting = 0
        """Frames that were taken and are not confirmed yet."""
        self._queue: deque[Frame] = deque()
        self._carried = 0

    def carry(self) -> None:
        """Carry what waits: its confirmations can be received now."""
        self._carried = len(self._queue)
        self.waiting = 0

    def forget(self) -> None:
        """Forget the waiting frames, which may still be carried later."""
        self.waiting = 0

    def now_s(self) -> float | None:
        return None

    def set_id_filter(self, frame_ids: frozenset[int]) -> None:
        pass

    def recv(self, timeout: float | None) -> can.Message | None:  # noqa: ARG002 - it never waits
        if self._carried == 0:
            return None
        self._carried -= 1
        return self._queue.popleft()

    def send(self, msg: can.Message, timeout: float | None = None) -> None:  # noqa: ARG002 - it never waits
        self.attempts.append(msg)
        if self.refuses:
            self.refused.append(len(self.attempts) - 1)
            raise can.CanOperationError("transmit queue is full")
        if self.receives_own_frames:
            self.waiting += 1
            confirmation = Frame(msg.arbitration_id, bytes(msg.data))
            confirmation.is_rx = False
            self._queue.append(confirmation)
        if self.interrupt is not None:
            interrupt, self.interrupt = self.interrupt, None
            interrupt()

    def shutdown(self) -> None:
        pass


class InterruptedSenses(SensorReadings):
    """A signal handler of the same thread runs while the guard reads the bumpers."""

    interrupt: Callable[[], None] | None = None

    @property
    def bumpers(self) -> int:
        if self.interrupt is not None:
            self.interrupt()
        return self[6]


def _is_control(msg: can.Message) -> bool:
    special = msg.is_extended_id or msg.is_remote_frame or msg.is_error_frame or msg.is_fd
    return msg.arbitration_id == 1 and msg.dlc == len(msg.data) == 8 and not special


@dataclass(frozen=True, eq=False)
class Played:
    """Results of streams; arrays are (streams, ticks), those of frames (frames, 8) and (frames,)."""

    payloads: NDArray[np.uint8]
    """Every frame that was to go out, in order."""
    refused: Flags
    """Frames that the bus did not take."""
    first_frame: Bytes
    """Number of a tick's first frame."""
    first_of_drive: Bytes
    """Number of the first frame after the tick's stops and the watchdog's look."""
    end: Bytes
    """Number after the tick's last frame."""
    waiting: Bytes
    """Frames that wait unconfirmed when the tick comes to drive."""
    interrupted: Flags
    """An early signal came, for the guard read the bumpers."""
    applied_left_m_s: Floats
    applied_right_m_s: Floats
    reasons: Bytes
    """Numbers of `reasons_of`."""
    reasons_of: list[tuple[str, ...]]
    latched: Flags
    """Latched state in each guard result."""
    latched_because: NDArray[np.object_]
    """Reason of the latched stop after each tick; empty if not latched."""
    send_failures: list[int]
    """Send failures of the guard after each stream."""
    strange: list[can.Message]
    """Frames that are no classic data frames of CONTROL's identifier and length; they have a payload of noughts."""


_Noted = tuple[int, int, int, int, bool, str]
"""Frames of the tick (first, first of drive, end), waiting frames, early signal, and reason of the latched stop."""


def play(streams: Streams, make_guard: MakeGuard = guard_on) -> Played:
    """Let one guard for each stream live through it."""
    end = SlowBus(receives_own_frames=streams.receives_own_frames)
    grants: list[GuardResult] = []
    noted: list[_Noted] = []
    send_failures = [_play_one(streams, at, end, make_guard, grants, noted) for at in range(streams.shape[0])]

    shape = streams.shape
    applied = np.array([grant.wheel_speeds for grant in grants], dtype=float)
    numbers: dict[tuple[str, ...], int] = {}
    reasons = [numbers.setdefault(grant.reasons, len(numbers)) for grant in grants]
    counts = np.array([note[:5] for note in noted], dtype=np.int64).reshape(*shape, 5)
    strange = [frame for frame in end.attempts if not _is_control(frame)]
    payloads = [bytes(8) if frame in strange else bytes(frame.data) for frame in end.attempts]
    refused = np.zeros(len(payloads), dtype=bool)
    refused[end.refused] = True
    return Played(
        payloads=np.frombuffer(b"".join(payloads), dtype=np.uint8).reshape(-1, 8),
        refused=refused,
        first_frame=counts[:, :, 0],
        first_of_drive=counts[:, :, 1],
        end=counts[:, :, 2],
        waiting=counts[:, :, 3],
        interrupted=counts[:, :, 4] != 0,
        applied_left_m_s=applied[:, 0].reshape(shape),
        applied_right_m_s=applied[:, 1].reshape(shape),
        reasons=np.array(reasons, dtype=np.int64).reshape(shape),
        reasons_of=list(numbers),
        latched=np.array([grant.latched for grant in grants]).reshape(shape),
        latched_because=np.array([because for *_, because in noted], dtype=object).reshape(shape),
        send_failures=send_failures,
        strange=strange,
    )


def _play_one(
    streams: Streams, at: int, end: SlowBus, make_guard: MakeGuard, grants: list[GuardResult], noted: list[_Noted]
) -> int:
    """One stream; notes what happens and returns the guard's count of frames that the bus refused."""
    bus = CanBus("slow", lambda _: end)
    end.carry()
    bus.drain()
    guard = make_guard(streams.robot, bus)
    watchdog_s = 0.0
    watchdog = Watchdog(guard, streams.robot.guard.ticks_ceased_s, lambda: watchdog_s)
    attempts = end.attempts
    # What is rare is asked for in one go: the test's time is spent in the loop below.
    events = (streams.stop, streams.release, streams.stop_again, streams.early_signal, streams.signal, streams.refuses)
    eventful = np.logical_or.reduce([flags[at] for flags in events]).tolist()

    interrupted = False

    def interrupt() -> None:
        guard.emergency_stop(SIGNAL)

    def interrupt_early() -> None:
        nonlocal interrupted
        interrupted = True
        guard.emergency_stop(SIGNAL)

    for tick, (wanted, readings, decided_at_s, now_s, watchdog_s, carries, hangs) in enumerate(
        zip(
            map(WheelSpeeds, streams.left_m_s[at].tolist(), streams.right_m_s[at].tolist()),
            _readings(streams, at),
            streams.decided_at_s[at].tolist(),
            streams.now_s[at].tolist(),
            streams.watchdog_s[at].tolist(),
            streams.carries[at].tolist(),
            streams.hangs[at].tolist(),
            strict=True,
        )
    ):
        first = len(attempts)
        if end.receives_own_frames:
            if carries:
                end.carry()
            bus.drain()
        if eventful[tick]:
            end.refuses = bool(streams.refuses[at, tick])
            if streams.stop[at, tick]:
                guard.emergency_stop(FIRST)
            if streams.release[at, tick]:
                if guard.latched == GuardReason.BUS_BLOCKED:
                    end.forget()  # as the guard does, for frames that were lost would wait for ever
                guard.release()
            if streams.stop_again[at, tick]:
                guard.emergency_stop(AGAIN)
        if watchdog.check(watchdog_s):
            guard.emergency_stop(GuardReason.TICKS_CEASED)
        if eventful[tick]:
            end.interrupt = interrupt if streams.signal[at, tick] else None
            if streams.early_signal[at, tick]:
                readings = InterruptedSenses(*readings)
                readings.interrupt = interrupt_early
        waiting, first_of_drive = end.waiting, len(attempts)
        grants.append(guard.drive(wanted, readings, decided_at_s, now_s))
        noted.append((first, first_of_drive, len(attempts), waiting, interrupted, guard.latched or ""))
        if eventful[tick]:
            end.refuses = interrupted = False
        if not hangs:
            watchdog.beat()
    return guard.send_failures


def _readings(streams: Streams, at: int) -> "map[SensorReadings]":
    infrared_counts = (200,) * len(streams.robot.infrared.sensors)
    ticks = streams.shape[1]
    return map(
        SensorReadings,
        streams.sensed_at_s[at].tolist(),
        [infrared_counts] * ticks,
        streams.infrared_age_s[at].tolist(),
        [0] * ticks,
        [0] * ticks,
        streams.encoder_age_s[at].tolist(),
        streams.bumpers[at].tolist(),
        streams.bumper_age_s[at].tolist(),
    )
