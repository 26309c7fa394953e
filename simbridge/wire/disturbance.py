"""Chance on the wire: noise that destroys a transmission, and receivers that miss a frame."""

import math

import can

from simbridge.noise import Noise
from simbridge.wire.settings import LossSettings, NoiseSettings

_NS_PER_S = 1_000_000_000
_NEVER = (1 << 62, 1 << 62)


class BusNoise:
    """Noise on the wire. Asked about transmissions in the order of their time."""

    def __init__(self, settings: NoiseSettings, seed: int) -> None:
        self._destroyed_share = settings.destroyed_share
        self._set = [(_ns(begin_s), _ns(end_s)) for begin_s, end_s in reversed(settings.bursts_s)]
        self._gap_ns, self._length_ns = _ns(settings.burst_gap_s), _ns(settings.burst_length_s)
        # Streams of their own: a single destroyed frame must not move the bursts.
        self._single, self._bursts = Noise(seed, "destroyed frames"), Noise(seed, "bursts of noise")
        self._next_set = self._set.pop() if self._set else _NEVER
        self._next_drawn = self._draw(0) if self._gap_ns else _NEVER

    def corrupted_at_ns(self, start_ns: int, end_ns: int) -> int | None:
        """When noise first meets a transmission that would last from `start_ns` to `end_ns`; None: it does not."""
        while self._next_set[1] <= start_ns:
            self._next_set = self._set.pop() if self._set else _NEVER
        while self._next_drawn[1] <= start_ns:
            self._next_drawn = self._draw(self._next_drawn[1])
        strike_ns = max(start_ns, min(self._next_set[0], self._next_drawn[0]))
        if self._destroyed_share and self._single.fraction() < self._destroyed_share:
            strike_ns = min(strike_ns, start_ns + int(self._single.fraction() * (end_ns - start_ns)))
        return strike_ns if strike_ns < end_ns else None

    def _draw(self, after_ns: int) -> tuple[int, int]:
        begin_ns = after_ns + 1 + self._exponential(self._gap_ns)
        return begin_ns, begin_ns + self._exponential(self._length_ns)

    def _exponential(self, mean_ns: int) -> int:
        return int(-mean_ns * math.log(1.0 - self._bursts.fraction()))


class FrameLoss:
    """Receivers that miss frames which the wire carried."""

    def __init__(self, settings: LossSettings, seed: int) -> None:
        self._share = settings.share
        self._share_by_id = dict(settings.shares_by_id)
        self._noise = Noise(seed, "missed frames")

    def drops(self, frame: can.Message) -> bool:
        """Whether a receiver misses this frame; to be asked once for each receiver."""
        share = self._share
        if self._share_by_id and not frame.is_extended_id:
            share = self._share_by_id.get(frame.arbitration_id, share)
        return share > 0.0 and self._noise.fraction() < share


def _ns(seconds: float) -> int:
    return round(seconds * _NS_PER_S)
