"""What was heard on the bus in a while, of every kind of frame."""

import statistics
from collections import Counter
from dataclasses import dataclass, field
from typing import NamedTuple

from hal.robot import WheelSpeeds
from hal.robot_settings import RobotSettings


class EncoderFrame(NamedTuple):
    """Ticks of one ENCODER frame, forward positive, and when it came."""

    time_s: float
    left: int
    right: int


class Identity(NamedTuple):
    """What INFO_1 or INFO_2 said."""

    hardware_id: int
    firmware: int
    loop_counter: int


@dataclass(slots=True)
class FrameStatistics:
    """Collected by the listener; times are on the bench's clock."""

    arrivals_s: dict[int, list[float]] = field(default_factory=dict)
    """By identifier, of every frame that is a standard data frame."""
    encoder: list[EncoderFrame] = field(default_factory=list)
    channels: dict[str, list[int]] = field(default_factory=dict)
    """Counts by analog channel, one for each frame."""
    bumpers: list[int] = field(default_factory=list)
    """Bits, one value for each BUMPERC frame."""
    identities: dict[str, list[Identity]] = field(default_factory=dict)
    """By message name."""
    junk: Counter[str] = field(default_factory=Counter)
    """What was wrong with frames, and how often."""
    control: int = 0
    """CONTROL frames, ours among them."""

    def period_s(self, frame_id: int) -> float | None:
        """Mean period of a frame; None when it came less than twice."""
        times_s = self.arrivals_s.get(frame_id, [])
        if len(times_s) < 2 or times_s[-1] <= times_s[0]:
            return None
        return (times_s[-1] - times_s[0]) / (len(times_s) - 1)

    def median(self, channel: str) -> float | None:
        """Median counts of a channel; None when it was not heard."""
        counts = self.channels.get(channel)
        return statistics.median(counts) if counts else None

    def wheel_speeds(self, robot: RobotSettings, last_frames: int) -> WheelSpeeds:
        """Mean speeds over the last ENCODER frames, one for each of the controller's cycles; 0 when none came."""
        frames = self.encoder[-last_frames:]
        if not frames:
            return WheelSpeeds(0.0, 0.0)
        metres_s = robot.geometry.metres_per_tick / robot.can.cycle_s / len(frames)
        return WheelSpeeds(sum(each.left for each in frames) * metres_s, sum(each.right for each in frames) * metres_s)

    def rest_began_s(self) -> float | None:
        """When the wheels had come to rest: the first of the ENCODER frames without a tick that last to the end.

        None when they still turn, or when nothing is heard of them.
        """
        rested_s = None
        for frame in reversed(self.encoder):
            if abs(frame.left) > _REST_TICKS or abs(frame.right) > _REST_TICKS:
                break
            rested_s = frame.time_s
        return rested_s


_REST_TICKS = 2
"""An encoder may stand on an edge and flicker."""
