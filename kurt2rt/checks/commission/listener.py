"""Listener to all frames, and their statistics, on its own CAN interface; the robot's driver filters for its own."""

import statistics
from collections import Counter
from dataclasses import dataclass, field
from typing import NamedTuple

import can

from hal.bus import CONTROL_ID, CanBus
from hal.codec import Codec, InvalidFrameError, MessageCodec
from hal.kurt2_settings import DISTANCE_CHANNEL, Kurt2Settings
from hal.robot import HIGHEST_COUNTS, WheelSpeeds

_REST_TICKS = 2
"""Ticks that an encoder on an edge may flicker."""


class EncoderFrame(NamedTuple):
    """Ticks of one ENCODER frame, forward positive, with its arrival time."""

    time_s: float
    left: int
    right: int


class Identity(NamedTuple):
    """Content of an INFO_1 or INFO_2 frame, by which a controller names itself."""

    hardware_id: int
    firmware: int
    loop_counter: int


@dataclass(slots=True)
class FrameStatistics:
    """Frames heard in a time span, by which steps judge; times on the test stand's clock."""

    arrivals_s: dict[int, list[float]] = field(default_factory=dict)
    """Arrival times of standard data frames by identifier."""
    encoder: list[EncoderFrame] = field(default_factory=list)
    channels: dict[str, list[int]] = field(default_factory=dict)
    """Counts by analog channel, one per frame."""
    bumpers: list[int] = field(default_factory=list)
    """Bits, one value per BUMPERC frame."""
    identities: dict[str, list[Identity]] = field(default_factory=dict)
    """Identities by message name."""
    junk: Counter[str] = field(default_factory=Counter)
    """Number of invalid frames by fault."""
    control: int = 0
    """CONTROL frames, including our own."""

    def period_s(self, frame_id: int) -> float | None:
        """Return the mean period of a frame in s; None if it came less than twice."""
        times_s = self.arrivals_s.get(frame_id, [])
        if len(times_s) < 2 or times_s[-1] <= times_s[0]:
            return None
        return (times_s[-1] - times_s[0]) / (len(times_s) - 1)

    def median(self, channel: str) -> float | None:
        """Return the median counts of a channel; None without a frame."""
        counts = self.channels.get(channel)
        return statistics.median(counts) if counts else None

    def wheel_speeds(self, robot: Kurt2Settings, last_frames: int) -> WheelSpeeds:
        """Return the mean speeds in m/s over the last ENCODER frames, one per controller cycle; 0 without frames."""
        frames = self.encoder[-last_frames:]
        if not frames:
            return WheelSpeeds(0.0, 0.0)
        metres_s = robot.geometry.metres_per_tick / robot.cycle_s / len(frames)
        return WheelSpeeds(sum(each.left for each in frames) * metres_s, sum(each.right for each in frames) * metres_s)

    def rest_began_s(self) -> float | None:
        """Return the time in s of the first ENCODER frame of the final rest; None while turning or without frames."""
        rested_s = None
        for frame in reversed(self.encoder):
            if abs(frame.left) > _REST_TICKS or abs(frame.right) > _REST_TICKS:
                break
            rested_s = frame.time_s
        return rested_s


class Listener:
    """Decoder of all frames of the robot's bus, on an interface of its own; it sends nothing."""

    def __init__(self, bus: CanBus, codec: Codec) -> None:
        """Take ownership of the interface."""
        self._bus = bus
        self._codec = codec
        named = {channel for each in codec.by_id.values() for channel in each.signals}
        self._distances = frozenset(filter(DISTANCE_CHANNEL.fullmatch, named))
        self.channels: set[str] = set()
        """Analog channels received so far."""
        self.has_bumpers = False
        """True once BUMPERC was received."""
        self.hardware_id: int | None = None
        """Hardware id of the last INFO_1."""

    def poll(self, now_s: float, heard: FrameStatistics) -> None:
        """Collect the waiting frames; their times are on the clock of `now_s`. Raises hal.bus.BusError."""
        messages = self._bus.drain()
        bus_now_s = self._bus.now_s() if messages else None
        for message in messages:
            age_s = 0.0 if bus_now_s is None else max(0.0, bus_now_s - message.timestamp)
            self._add(message, now_s - age_s, heard)

    def close(self) -> None:
        """Close the CAN interface; nothing is heard afterwards."""
        self._bus.shutdown()

    def _add(self, message: can.Message, at_s: float, heard: FrameStatistics) -> None:
        if message.is_error_frame:
            heard.junk["error frames of the bus"] += 1
            return
        if message.is_extended_id or message.is_remote_frame:
            heard.junk["extended or remote frames"] += 1
            return
        frame_id = message.arbitration_id
        heard.arrivals_s.setdefault(frame_id, []).append(at_s)
        if frame_id == CONTROL_ID:
            heard.control += 1
            return
        codec = self._codec.by_id.get(frame_id)
        if codec is None:
            return
        try:
            self._decode(codec, message.data, at_s, heard)
        except InvalidFrameError as error:
            heard.junk[str(error)] += 1

    def _decode(self, codec: MessageCodec, data: bytes | bytearray, at_s: float, heard: FrameStatistics) -> None:
        values = codec.unpack(data)
        if codec.name == "ENCODER":
            heard.encoder.append(EncoderFrame(at_s, *values))
        elif codec.name == "BUMPERC":
            heard.bumpers.append(values[0])
            self.has_bumpers = True
        elif codec.name in ("INFO_1", "INFO_2"):
            identity = Identity(*values)
            heard.identities.setdefault(codec.name, []).append(identity)
            if codec.name == "INFO_1":
                self.hardware_id = identity.hardware_id
        else:
            for channel, counts in zip(codec.signals, values, strict=True):
                if channel not in self._distances:
                    continue
                if counts > HIGHEST_COUNTS:
                    heard.junk[f"{channel} above {HIGHEST_COUNTS} counts"] += 1
                else:
                    heard.channels.setdefault(channel, []).append(counts)
                    self.channels.add(channel)
