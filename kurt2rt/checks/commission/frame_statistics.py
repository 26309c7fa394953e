"""Statistics of all frames received in a time span."""

import statistics
from collections import Counter
from dataclasses import dataclass, field
from typing import NamedTuple

from hal.kurt2_settings import Kurt2Settings
from hal.robot import WheelSpeeds


class EncoderFrame(NamedTuple):
    """Ticks of one ENCODER frame, forward positive, with its arrival time."""

    time_s: float
    left: int
    right: int


class Identity(NamedTuple):
    """Content of INFO_1 or INFO_2."""

    hardware_id: int
    firmware: int
    loop_counter: int


@dataclass(slots=True)
class FrameStatistics:
    """Frames collected by the listener; times on the test stand's clock."""

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


_REST_TICKS = 2
"""Ticks that an encoder on an edge may flicker."""
