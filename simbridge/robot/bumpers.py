"""Bumpers at both ends of the body, and a counter of collisions."""

from collections.abc import Sequence

from hal.robot_settings import BumperEnd, BumperSettings, GeometrySettings
from simbridge.robot.body import Contact

_FACE_DEPTH_M = 0.01
"""Distance from the end face within which a contact presses the bumper bar."""
_EDGE_M = 0.001
"""Overlap of a bumper's edge, so that rounding does not decide at a corner of the body."""
_HEAD_ON = 0.5
"""Least longitudinal component of a contact's direction that presses a bumper; side contact does not."""


class Bumpers:
    """Converter of contact points to BUMPERC's bits; the bumpers of an end share its width, left to right."""

    def __init__(self, bumpers: Sequence[BumperSettings], geometry: GeometrySettings) -> None:
        self._half_length_m = geometry.outline_length_m / 2
        half_width_m = geometry.outline_width_m / 2
        self._reaches: dict[BumperEnd, list[tuple[int, float, float]]] = {}
        for end in BumperEnd:
            bits = [bit for bit, bumper in enumerate(bumpers) if bumper.end is end]
            width_m = geometry.outline_width_m / max(1, len(bits))
            self._reaches[end] = [
                (1 << bit, half_width_m - (i + 1) * width_m, half_width_m - i * width_m) for i, bit in enumerate(bits)
            ]

    def pressed(self, contacts: Sequence[Contact]) -> int:
        """Return the bits of the pressed bumpers; a wall with two contacts presses all bumpers between them."""
        return self._at(BumperEnd.FRONT, 1.0, contacts) | self._at(BumperEnd.REAR, -1.0, contacts)

    def _at(self, end: BumperEnd, sign: float, contacts: Sequence[Contact]) -> int:
        lateral_m = [
            contact.y_m
            for contact in contacts
            if sign * contact.x_m > self._half_length_m - _FACE_DEPTH_M and sign * contact.toward_x > _HEAD_ON
        ]
        if not lateral_m:
            return 0
        right_m, left_m = min(lateral_m), max(lateral_m)
        return sum(
            bit
            for bit, low_m, high_m in self._reaches[end]
            if low_m - _EDGE_M <= left_m and right_m <= high_m + _EDGE_M
        )


class CollisionCounter:
    """Counter of collisions; touches at most 0.5 s apart count as one, because a robot may bounce."""

    EPISODE_GAP_S = 0.5

    def __init__(self, cycle_s: float) -> None:
        self.gap_cycles = round(self.EPISODE_GAP_S / cycle_s)
        self._free_cycles = self.gap_cycles + 1
        self.count = 0

    def update(self, touching: bool) -> None:
        """Count a collision if `touching` begins; call it in each cycle."""
        if not touching:
            self._free_cycles += 1
            return
        if self._free_cycles > self.gap_cycles:
            self.count += 1
        self._free_cycles = 0

    def end_episode(self) -> None:
        """Count the next touch as a new collision, after the robot was repositioned."""
        self._free_cycles = self.gap_cycles + 1
