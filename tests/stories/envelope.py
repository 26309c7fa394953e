"""Motion envelope judged from messages alone, independent of the guard.

It shares no code with the guard or the guard's codec, so that an error of one cannot hide an error of the other.
"""

import math
from typing import NamedTuple

from tests.stories.table import Limits
from tests.stories.wire import BRAKE, KURT2, WheelCommand, Wire

_FRONT, _REAR = 0b000111, 0b111000
"""Bits of the bumpers at both ends."""
_ROUNDING = 1e-6
_MOST_UNDER_WAY = 2048
"""Frames in transit that are remembered; an older frame counts as lost."""
_TOUCH_S = 0.1
"""Time after a frame with a pressed bumper in which a set point must not push: a slow tick and the next one."""


class _SentFrame(NamedTuple):
    at_s: float
    age_s: float
    told: WheelCommand | None
    bumper_pressed: bool


class Envelope:
    """Check of all frames of one driver; `violations` holds the frames beyond the limits."""

    def __init__(self, limits: Limits, wire: Wire = KURT2) -> None:
        self.violations: list[str] = []
        self.frames = 0
        """Frames handed to the bus."""
        self.old_frames = 0
        """Set points that exceeded the age limit on arrival at the robot."""
        self.unintelligible = 0
        """Garbled frames that arrived; the robot ignores them."""
        self.clock_slowness = 1.0
        """Seconds in one second of the driver's clock, by which a robot without a clock of its own tells ages."""
        self.clock_is_faulty = False
        """True while the driver's clock jumps: each frame may change speed by the longest step."""
        self.bumpers = 0
        """Bits of the bumpers that the driver reads as pressed: blocked wheels stop and may reverse at once."""
        self._limits, self._wire = limits, wire
        self._in_transit: dict[int, _SentFrame] = {}
        self._heard_at_s: dict[int, float] = {}
        """Time of the newest frame of each identifier that the robot sends."""
        self._touched_at_s = {_FRONT: math.inf, _REAR: math.inf}
        """Time of the first frame with a pressed bumper of each end since a set point that did not push there."""
        self._last_put: _SentFrame | None = None
        self._last_arrived: _SentFrame | None = None
        self._arrived_number, self._arrived_at_s = 0, -math.inf

    def begin_program(self) -> None:
        """Expect a driver that knows nothing of what the one before it sent, and begins at rest."""
        self._last_put = _SentFrame(-math.inf, 0.0, BRAKE, bumper_pressed=False)
        self._touched_at_s.update(dict.fromkeys(self._touched_at_s, math.inf))

    def on_heard(self, frame_id: int, payload: bytes, at_s: float) -> None:
        """Note a frame that arrives at the notebook. `at_s`: simulated time in s."""
        if frame_id in self._wire.range_ids:
            self._heard_at_s[frame_id] = at_s
        if frame_id == self._wire.bumpers_id and payload:
            for end, since_s in self._touched_at_s.items():
                if payload[0] & end:
                    self._touched_at_s[end] = min(since_s, at_s)

    def on_sent(self, number: int, at_s: float, payload: bytes, age_s: float, *, latched: bool) -> None:
        """Check a frame that the driver hands to its bus; a violation is appended to `violations`.

        `number`: of the frame, in order. `at_s`: simulated time in s. `age_s`: time in s since its decision began.
        `latched`: whether the guard keeps the robot stopped.
        """
        self.frames += 1
        told = self._wire.decode(payload)
        put = _SentFrame(at_s, age_s, told, self.bumpers != 0)
        self._in_transit[number] = put
        self._in_transit.pop(number - _MOST_UNDER_WAY, None)
        if told is None:
            self._complain(at_s, f"no set point and no brake: {payload.hex(' ')}")
            return
        if not told.standing and not age_s <= self._limits.command_age_s + _ROUNDING:
            self._complain(at_s, f"a command {age_s * 1000:.1f} ms old")
        fastest_m_s, slowest_m_s = max(told.left_m_s, told.right_m_s), min(told.left_m_s, told.right_m_s)
        if (self.bumpers & _FRONT and fastest_m_s > 0.0) or (self.bumpers & _REAR and slowest_m_s < 0.0):
            self._complain(at_s, f"pushes on towards the bumpers {self.bumpers:06b}")
        for end, pushes in ((_FRONT, fastest_m_s > 0.0), (_REAR, slowest_m_s < 0.0)):
            if not pushes:
                self._touched_at_s[end] = math.inf
            elif at_s - self._touched_at_s[end] > _TOUCH_S:
                self._complain(at_s, f"pushed on since bumpers {end:06b} touched at {self._touched_at_s[end]:.3f} s")
        senses_age_s = at_s - min(self._heard_at_s.values(), default=-math.inf)
        if not told.standing and senses_age_s > self._limits.senses_age_s * self.clock_slowness + _ROUNDING:
            self._complain(at_s, f"moves though range sensors were silent for {senses_age_s * 1000:.0f} ms")
        if latched and not told.brake:
            self._complain(at_s, "no brake though the robot is to stay stopped")
        self._require_slow(at_s, told)
        if self._last_put is not None and self._last_put.told is not None:
            longest_s = self._limits.longest_step_s
            by_frame = self.clock_is_faulty or self._last_put.told.brake
            elapsed_s = longest_s if by_frame else at_s - self._last_put.at_s
            self._require_smooth(at_s, self._last_put.told, put, told, min(elapsed_s, longest_s))
        self._last_put = put

    def on_arrived(self, number: int, at_s: float, payload: bytes) -> WheelCommand | None:
        """Check a frame that arrives at the robot; return its command, None for an unknown payload.

        `number`: as in `on_sent`. `at_s`: simulated time in s.
        """
        told = self._wire.decode(payload)
        if told is None:
            self.unintelligible += 1
            return None
        put = self._in_transit.pop(number, None)
        if put is None:
            self._complain(at_s, f"frame {number} arrives twice, or after {_MOST_UNDER_WAY} others")
            return told
        if not told.standing and put.age_s + at_s - put.at_s > self._limits.command_age_s + _ROUNDING:
            self.old_frames += 1
        self._require_slow(at_s, told)
        if self._last_arrived is not None and self._last_arrived.told is not None:
            # By the times at which they were made: what was held up may come in a heap.
            elapsed_s = put.at_s - self._last_arrived.at_s
            longest_s = self._limits.longest_step_s
            if self._last_arrived.told.brake:
                # The first step after a brake may be the longest, two cycles, and may be one of those that were lost.
                elapsed_s = max(elapsed_s + longest_s / 2, longest_s)
            elif self.clock_is_faulty:
                elapsed_s = max(elapsed_s, longest_s * (number - self._arrived_number))
            # A stop may be among frames that were lost on the way: it is free, and what comes after it may turn round.
            # A robot that heard nothing for so long stands by itself.
            rested = at_s - self._arrived_at_s >= self._limits.controller_watchdog_s
            follows = number == self._arrived_number + 1 and not rested
            self._require_smooth(at_s, self._last_arrived.told, put, told, elapsed_s, follows=follows)
        self._last_arrived = put
        self._arrived_number, self._arrived_at_s = number, at_s
        return told

    def _require_slow(self, at_s: float, told: WheelCommand) -> None:
        fastest_m_s = max(abs(told.left_m_s), abs(told.right_m_s))
        if fastest_m_s > self._limits.speed_m_s + _ROUNDING:
            self._complain(at_s, f"{fastest_m_s:.2f} m/s")

    def _require_smooth(
        self,
        at_s: float,
        before: WheelCommand,
        put: _SentFrame,
        told: WheelCommand,
        elapsed_s: float,
        *,
        follows: bool = True,
    ) -> None:
        limits = self._limits
        for side, old_m_s, new_m_s in (
            ("left", before.left_m_s, told.left_m_s),
            ("right", before.right_m_s, told.right_m_s),
        ):
            if new_m_s == 0.0:
                continue  # to stand is allowed at once
            if not follows and (old_m_s * new_m_s < 0.0 or abs(new_m_s) < abs(old_m_s)):
                continue
            if old_m_s * new_m_s < 0.0 and (put.bumper_pressed or min(abs(old_m_s), abs(new_m_s)) <= limits.rest_m_s):
                old_m_s = 0.0
            if old_m_s * new_m_s < 0.0:
                self._complain(at_s, f"{side} turns round from {old_m_s:.2f} to {new_m_s:.2f} m/s without a rest")
                continue
            gained_m_s = abs(new_m_s) - abs(old_m_s)
            limit_m_s2 = limits.acceleration_m_s2 if gained_m_s > 0 else limits.braking_m_s2
            allowed_m_s = limit_m_s2 * elapsed_s + limits.resolution_m_s
            if abs(gained_m_s) > allowed_m_s + _ROUNDING:
                within = f"in {elapsed_s * 1000:.0f} ms, allowed are {allowed_m_s:.3f} m/s"
                self._complain(at_s, f"{side} jumps from {old_m_s:.2f} to {new_m_s:.2f} m/s {within}")

    def _complain(self, at_s: float, text: str) -> None:
        self.violations.append(f"at {at_s:.3f} s: {text}")
