"""CAN frames of KURT2 that carry distance sensors."""

import math
from collections.abc import Callable
from typing import NamedTuple

from hal.codec import Codec, CodecError, InvalidFrameError, MessageCodec
from hal.guarded_robot import Arrivals
from hal.infrared_watch import Board, InfraredWatch
from hal.robot import HIGHEST_COUNTS

_BOARDS = {"ADC": "first controller (ADC*)", "BDC": "second controller (BDC*)"}


def board_of(channel: str) -> str:
    """Return the name of the board of an analog channel, such as ADC00 (docs/the-robot.md#messages)."""
    return _BOARDS[channel[:3]]


class InfraredCounts(NamedTuple):
    """Newest count of each distance sensor, and arrival time of each frame that carries some."""

    counts: list[int]
    times_s: list[float]
    """One per frame, in s; minus infinity before its first."""


FrameReader = Callable[[bytes | bytearray, float, Arrivals], None]
"""Store the values of one frame that arrived at that time, in s. Raises InvalidFrameError, changing nothing."""


class InfraredFrame:
    """Frame of a converter: the places of its channels in the counts of all sensors, and its board."""

    __slots__ = ("board", "codec", "counts", "last_payload", "places", "row", "times_s")

    def __init__(
        self, codec: MessageCodec, places: tuple[tuple[int, int], ...], board: Board, newest: InfraredCounts
    ) -> None:
        """Add a row to `newest`; `places`: (place in the frame, place in `newest.counts`) of each distance channel."""
        self.counts, self.times_s = newest
        self.row = len(self.times_s)
        self.times_s.append(-math.inf)
        self.codec = codec
        self.places = places
        self.board = board
        self.last_payload: bytes | bytearray = b""

    def read(self, data: bytes | bytearray, at_s: float, arrivals: Arrivals) -> None:
        """Store the counts and the time `at_s`, in s, of a frame's distance channels; note changes in `arrivals`.

        Raises InvalidFrameError, changing nothing, for a payload that is too short or a count above the range.
        """
        if data != self.last_payload:
            raw, counts = self.codec.unpack(data), self.counts
            for at, _ in self.places:
                # The C167 keeps the channel number in the upper bits (docs/the-robot.md#range-of-a-channel).
                if raw[at] > HIGHEST_COUNTS:
                    raise InvalidFrameError(f"{self.codec.name}: {raw[at]} counts (allowed 0 to {HIGHEST_COUNTS})")
            changed = False
            for at, sensor in self.places:
                if counts[sensor] != raw[at]:
                    counts[sensor] = raw[at]
                    changed = True
            if changed:
                self.board.still_s = 0.0
                arrivals.infrared_changed = True
            self.last_payload = data
        self.times_s[self.row] = at_s


def infrared_frames(
    channels: tuple[str, ...], codec: Codec, watch: InfraredWatch, newest: InfraredCounts
) -> tuple[InfraredFrame, ...]:
    """Return the frames that carry channels of the sensor table; channel names are signal names.

    Args:
        channels: channel of each sensor, in the order of the table.
        codec: of all messages.
        watch: has the board of each channel.
        newest: counts and times of all sensors, which the frames write to.

    Raises:
        CodecError: no message carries a channel.
    """
    carried = {name for message in codec.by_id.values() for name in message.signals}
    missing = [channel for channel in channels if channel not in carried]
    if missing:
        raise CodecError(f"no message carries {', '.join(missing)}", where=codec.source, do="add them to a message")
    frames = []
    for message in codec.by_id.values():
        places = tuple((at, channels.index(name)) for at, name in enumerate(message.signals) if name in channels)
        if places:
            frames.append(InfraredFrame(message, places, watch.board(board_of(channels[places[0][1]])), newest))
    return tuple(frames)
