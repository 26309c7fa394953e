"""Guard's limits of speed, bumpers and slew as plain functions: the compiled loops of a batch take the same ones."""

from typing import NamedTuple

from hal.guard_reason import GuardReason
from hal.robot_settings import BumperEnd, RobotSettings

SPEED_LIMIT, FRONT_BUMPER, REAR_BUMPER, SLEW_LIMIT = 1, 2, 4, 8
"""Bits of the limits that set points met."""
_REASONS = {
    SPEED_LIMIT: GuardReason.SPEED_LIMIT,
    FRONT_BUMPER: GuardReason.FRONT_BUMPER,
    REAR_BUMPER: GuardReason.REAR_BUMPER,
    SLEW_LIMIT: GuardReason.SLEW_LIMIT,
}
REASONS = tuple(tuple(reason for bit, reason in _REASONS.items() if bits & bit) for bits in range(2 * SLEW_LIMIT))
"""Reasons of the guard, by the bits of the limits that were met."""

_LONGEST_SLEW_CYCLES = 2
"""Most cycles in which set points move at once: a late tick must not turn into a jump."""


class GuardLimits(NamedTuple):
    """Limits of the guard for one kind of robot."""

    cycle_s: float
    maximum_speed_m_s: float
    acceleration_m_s2: float
    braking_m_s2: float
    front_bits: int
    """Bits of the bumpers in front, as in `hal.robot.SensorReadings`."""
    rear_bits: int


def limits_of(robot: RobotSettings) -> GuardLimits:
    """Return the limits of a kind of robot."""

    def bits(end: BumperEnd) -> int:
        return sum(1 << bit for bit, bumper in enumerate(robot.bumpers) if bumper.end is end)

    guard = robot.guard
    return GuardLimits(
        robot.cycle_s,
        guard.maximum_speed_m_s,
        guard.acceleration_m_s2,
        guard.braking_m_s2,
        bits(BumperEnd.FRONT),
        bits(BumperEnd.REAR),
    )


def slewed(from_m_s: float, to_m_s: float, elapsed_s: float, limits: GuardLimits) -> float:
    """Return the set point of one side after `elapsed_s` on its way between two speeds in m/s."""
    if to_m_s == from_m_s or to_m_s == 0.0:
        return to_m_s  # a stop is not slewed: the controller brakes by itself
    if from_m_s * to_m_s < 0.0:
        to_m_s = 0.0  # a wheel comes to rest before it turns the other way
    speeds_up = abs(to_m_s) > abs(from_m_s)
    step_m_s = (limits.acceleration_m_s2 if speeds_up else limits.braking_m_s2) * elapsed_s
    if to_m_s > from_m_s:
        return min(to_m_s, from_m_s + step_m_s)
    return max(to_m_s, from_m_s - step_m_s)


def limited(
    wanted: tuple[float, float], present: tuple[float, float], bumpers: int, elapsed_s: float, limits: GuardLimits
) -> tuple[float, float, int]:
    """Return the set points of left and right side in m/s, and the bits of the limits that were met.

    Args:
        wanted: speeds of left and right side in m/s.
        present: set points of both sides in m/s.
        bumpers: bits of the pressed bumpers.
        elapsed_s: time since the present set points were told.
        limits: of this robot.
    """
    left_m_s, right_m_s = wanted
    from_left_m_s, from_right_m_s = present
    met = 0
    fastest_m_s = max(abs(left_m_s), abs(right_m_s))
    if fastest_m_s > limits.maximum_speed_m_s:
        met |= SPEED_LIMIT
        share = limits.maximum_speed_m_s / fastest_m_s  # of both sides, so that the curve is kept
        left_m_s *= share
        right_m_s *= share
    # At a bumper the old set points, too: slewing down from them would go on pushing.
    if bumpers & limits.front_bits:
        if left_m_s > 0.0 or right_m_s > 0.0:
            met |= FRONT_BUMPER
        left_m_s, right_m_s = min(left_m_s, 0.0), min(right_m_s, 0.0)
        from_left_m_s, from_right_m_s = min(from_left_m_s, 0.0), min(from_right_m_s, 0.0)
    if bumpers & limits.rear_bits:
        if left_m_s < 0.0 or right_m_s < 0.0:
            met |= REAR_BUMPER
        left_m_s, right_m_s = max(left_m_s, 0.0), max(right_m_s, 0.0)
        from_left_m_s, from_right_m_s = max(from_left_m_s, 0.0), max(from_right_m_s, 0.0)
    elapsed_s = min(elapsed_s, _LONGEST_SLEW_CYCLES * limits.cycle_s)
    to_left_m_s = slewed(from_left_m_s, left_m_s, elapsed_s, limits)
    to_right_m_s = slewed(from_right_m_s, right_m_s, elapsed_s, limits)
    if to_left_m_s != left_m_s or to_right_m_s != right_m_s:
        met |= SLEW_LIMIT
    return to_left_m_s, to_right_m_s, met
