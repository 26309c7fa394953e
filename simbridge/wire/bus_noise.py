"""Random faults of the wire: noise that destroys transmissions, and receivers that drop frames."""

import math

import can

from hal.numerics import round_portable
from simbridge.robot.noise import Noise
from simbridge.wire.settings import LossSettings, NoiseSettings

_NS_PER_S = 1_000_000_000
_NEVER = (1 << 62, 1 << 62)


class BusNoise:
    """Noise on the wire; queries must come in order of time."""

    def __init__(self, settings: NoiseSettings, seed: int) -> None:
        self._destroyed_probability = settings.destroyed_share
        self._fixed = [(_ns(begin_s), _ns(end_s)) for begin_s, end_s in reversed(settings.bursts_s)]
        self._gap_ns, self._length_ns = _ns(settings.burst_gap_s), _ns(settings.burst_length_s)
        # Separate streams: a single destroyed frame must not shift the bursts.
        self._single, self._bursts = Noise(seed, "destroyed frames"), Noise(seed, "bursts of noise")
        self._next_fixed = self._fixed.pop() if self._fixed else _NEVER
        self._next_drawn = self._draw(0) if self._gap_ns else _NEVER

    def corrupted_at_ns(self, start_ns: int, end_ns: int) -> int | None:
        """Return the time at which noise first hits a transmission from `start_ns` to `end_ns`; None for a miss."""
        while self._next_fixed[1] <= start_ns:
            self._next_fixed = self._fixed.pop() if self._fixed else _NEVER
        while self._next_drawn[1] <= start_ns:
            self._next_drawn = self._draw(self._next_drawn[1])
        hit_ns = max(start_ns, min(self._next_fixed[0], self._next_drawn[0]))
        if self._destroyed_probability and self._single.fraction() < self._destroyed_probability:
            hit_ns = min(hit_ns, start_ns + int(self._single.fraction() * (end_ns - start_ns)))
        return hit_ns if hit_ns < end_ns else None

    def _draw(self, after_ns: int) -> tuple[int, int]:
        begin_ns = after_ns + 1 + self._exponential(self._gap_ns)
        return begin_ns, begin_ns + self._exponential(self._length_ns)

    def _exponential(self, mean_ns: int) -> int:
        return int(-mean_ns * round_portable(math.log(1.0 - self._bursts.fraction())))


class FrameLoss:
    """Loss of carried frames at receivers."""

    def __init__(self, settings: LossSettings, seed: int) -> None:
        self._probability = settings.share
        self._probability_by_id = dict(settings.shares_by_id)
        self._noise = Noise(seed, "missed frames")

    def drops(self, frame: can.Message) -> bool:
        """Return whether a receiver drops this frame; call once per receiver."""
        probability = self._probability
        if self._probability_by_id and not frame.is_extended_id:
            probability = self._probability_by_id.get(frame.arbitration_id, probability)
        return probability > 0.0 and self._noise.fraction() < probability


def _ns(seconds: float) -> int:
    return round(seconds * _NS_PER_S)
