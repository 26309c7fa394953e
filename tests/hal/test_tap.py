"""Tap: sees each frame received and sent by its end, with its age."""

import can

from hal.bus import CanBus, CanInterface, open_bus
from hal.control import encode_brake
from hal.in_process_bus import InProcessBus
from tests.hal.helpers import CODEC, cycle, send


class Onlooker:
    """Keeps what it saw."""

    def __init__(self) -> None:
        self.heard_frames: list[tuple[int, float]] = []
        self.sent_frames: list[int] = []

    def on_rx(self, frame: can.Message, age_s: float) -> None:
        self.heard_frames.append((frame.arbitration_id, age_s))

    def on_tx(self, frame: can.Message) -> None:
        self.sent_frames.append(frame.arbitration_id)


def test_every_frame_that_is_heard_or_sent_is_seen_in_order(ends: tuple[CanBus, CanBus]) -> None:
    robot_end, far_end = ends
    onlooker = robot_end.tap = Onlooker()
    send(far_end, cycle())
    robot_end.control_port().send(encode_brake())
    robot_end.drain()
    assert onlooker.heard_frames == [(frame.arbitration_id, 0.0) for frame in cycle()]
    assert onlooker.sent_frames == [0x01]


class StampedBus(InProcessBus):
    """Its clock shows what the test sets, and a frame is stamped 5.0 s."""

    time_s = 0.0

    def now_s(self) -> float | None:
        return self.time_s

    def recv(self, timeout: float | None = None) -> can.Message | None:
        frame = super().recv(timeout)
        if frame is not None:
            frame.timestamp = 5.0
        return frame


def test_tapped_age_follows_the_bus_clock_and_is_never_negative() -> None:
    opened: list[StampedBus] = []

    def open_stamped(name: str) -> CanInterface:
        opened.append(StampedBus(name))
        return opened[-1]

    bus = CanBus("stamped", open_stamped)
    far_end = open_bus("virtual:stamped")
    onlooker = bus.tap = Onlooker()
    for now_s in (5.25, 4.0):
        opened[0].time_s = now_s
        send(far_end, [CODEC.message("ENCODER").pack(0, 0)])
        bus.drain()
    assert [age_s for _, age_s in onlooker.heard_frames] == [0.25, 0.0]
    for each in (bus, far_end):
        each.shutdown()
