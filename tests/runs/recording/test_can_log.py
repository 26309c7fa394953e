"""The CAN log keeps what passed on the bus, and the robot never waits for it."""

import errno
import threading
from collections.abc import Sequence

import can

from hal.control import encode_brake
from kurt2rt.runs.recording.can_log import CanLog
from tests.hal.helpers import CODEC, bus_pair, send

ENCODER = CODEC.message("ENCODER").frame_id


class Shelf:
    """A writer that keeps everything, unless it is told to fail."""

    def __init__(self) -> None:
        self.frames: list[can.Message] = []
        self.closed = False
        self.failure: Exception | None = None

    def write(self, frames: Sequence[can.Message]) -> None:
        if self.failure is not None:
            raise self.failure
        self.frames += frames

    def close(self) -> None:
        self.closed = True


class Stuck(Shelf):
    """A writer on a disk that does not answer, until it is set free."""

    def __init__(self) -> None:
        super().__init__()
        self.hangs = threading.Event()
        self.free = threading.Event()

    def write(self, frames: Sequence[can.Message]) -> None:
        self.hangs.set()
        self.free.wait()
        super().write(frames)


def encoder(left: int) -> can.Message:
    return CODEC.message("ENCODER").pack(left, 0)


def lefts(shelf: Shelf) -> list[int]:
    return [CODEC.message("ENCODER").unpack(frame.data)[0] for frame in shelf.frames]


def test_can_log_keeps_order_direction_and_channel() -> None:
    robot_end, far_end = bus_pair()
    shelf = Shelf()
    with CanLog(shelf, "x.log", robot_end.name) as log:
        robot_end.tap = log
        send(far_end, [encoder(1), encoder(2)])
        robot_end.drain()
        robot_end.control_port().send(encode_brake())
    assert [(frame.arbitration_id, frame.is_rx) for frame in shelf.frames] == [
        (ENCODER, True),
        (ENCODER, True),
        (0x01, False),
    ]
    assert {frame.channel for frame in shelf.frames} == {"can0"}
    assert (shelf.closed, log.written, log.lost, log.trouble) == (True, 3, 0, "")
    for end in (robot_end, far_end):
        end.shutdown()


def test_a_writer_that_hangs_costs_frames_but_no_time() -> None:
    stuck = Stuck()
    log = CanLog(stuck, "x.log", "can0", capacity_frames=10)
    log.start()
    log.on_rx(encoder(0), 0.0)
    assert stuck.hangs.wait(30.0)
    for left in range(1, 16):
        log.on_rx(encoder(left), 0.0)
    assert (log.written, log.lost) == (0, 5)
    assert "x.log: 5 " in log.trouble
    stuck.free.set()
    log.close(30.0)
    assert lefts(stuck) == list(range(11))
    assert (log.written, log.lost, stuck.closed) == (11, 5, True)


def test_the_end_of_the_run_gives_a_writer_up_that_hangs() -> None:
    stuck = Stuck()
    log = CanLog(stuck, "x.log", "can0")
    log.start()
    log.on_rx(encoder(0), 0.0)
    assert stuck.hangs.wait(30.0)
    log.close(0.0)
    assert "x.log: " in log.trouble
    stuck.free.set()


def test_a_writer_that_fails_is_told_of_and_tried_again() -> None:
    failure = OSError(errno.ENOSPC, "full")
    shelf = Shelf()
    log = CanLog(shelf, "x.log", "can0")
    shelf.failure = failure
    log.on_rx(encoder(1), 0.0)
    log.on_rx(encoder(2), 0.0)
    log.write_waiting()
    assert "x.log" in log.trouble
    assert str(failure) in log.trouble
    shelf.failure = None
    log.on_rx(encoder(3), 0.0)
    log.write_waiting()
    assert (lefts(shelf), log.written, log.lost) == ([3], 1, 2)
    assert "x.log: 2 " in log.trouble


def test_a_file_that_cannot_be_closed_is_told_of() -> None:
    class Unclosable(Shelf):
        def close(self) -> None:
            raise OSError(errno.EIO, "broken")

    with CanLog(Unclosable(), "x.log", "can0") as log:
        pass
    assert "x.log" in log.trouble
    assert "broken" in log.trouble
