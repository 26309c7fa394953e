"""Guard's limits and watches of a batch, for robots that nothing disturbs.

Readings are always fresh and no other node sends CONTROL, so only bumpers, the limits of speed and slew, the watch for
frozen boards and the watch for single broken sensors can act. The watch of the wheels cannot: a sound motor stays
within its band (tests/simbridge/batch/test_laws.py).
"""

import math

from hal.guard_limits import LONGEST_SLEW_CYCLES, SLEW_LIMIT, GuardLimits, bounded, slewed
from hal.sensor_signs import (
    AGREES_COUNTS,
    DARK_DIFFERS_COUNTS,
    DARK_TICKS,
    DIFFERS_COUNTS,
    KEEPS,
    LOOK_TICKS,
    PASSES_M,
    PHANTOM_TICKS,
    QUIET_COUNTS,
    QUIET_RATIO,
    RANGE_TICKS,
    STUCK_BAND,
    SWING_COUNTS,
)
from simbridge.batch.compiled import compiled
from simbridge.batch.laws import Integers, WatchLaw
from simbridge.batch.record import SIGNS, Robot

_LOW, _HIGH, _QUIET_LOW, _QUIET_HIGH, _BEFORE_LOW, _BEFORE_HIGH, _AFTER_LOW, _AFTER_HIGH = range(8)
_DRIVEN, STILL_FROM, _LOW_TICKS, _HIGH_TICKS, _OUT_TICKS, _AGREED_TICKS = range(8, SIGNS)
UNSEEN = -1000
"""First value of the bands of `hal.sensor_signs`."""
_ROUNDING = 1e-6
"""Set points are truncated to whole cm/s beyond this (hal.control)."""

_bounded = compiled(bounded)
_slewed = compiled(slewed)


@compiled
def is_frozen(robot: Robot, now_s: float, law: WatchLaw) -> bool:
    """Return whether a board of a robot repeats itself for too long (hal.infrared_watch); call it in each tick."""
    elapsed_s = max(0.0, now_s - robot.looked_at_s)
    robot.looked_at_s = now_s
    if not robot.turned:
        return False
    frozen = False
    for board in range(robot.board_still_s.shape[0]):
        robot.board_still_s[board] += elapsed_s
        frozen = frozen or robot.board_still_s[board] >= law.frozen_s
    return frozen


@compiled
def looks_broken(robot: Robot, law: WatchLaw) -> bool:
    """Return whether a sensor of a robot shows a sign of a fault (hal.sensor_watch); call it in each tick."""
    if robot.bumpers == 0:
        robot.driven += robot.turned * robot.way_counts
        robot.watch_left_ticks += robot.left_ticks
        robot.watch_right_ticks += robot.right_ticks
    if robot.tick % LOOK_TICKS:
        return False
    left_m = robot.watch_left_ticks * law.metres_per_tick
    right_m = robot.watch_right_ticks * law.metres_per_tick
    motion = (left_m + right_m) / 2, (right_m - left_m) / law.track_m
    robot.watch_left_ticks = robot.watch_right_ticks = 0
    found = False
    for i in range(robot.counts.shape[0]):
        if _update_signs(robot, i, motion, law):
            found = found or _shows_fault(robot, i, law)
    return found


@compiled
def _update_signs(robot: Robot, i: int, motion: tuple[float, float], law: WatchLaw) -> bool:
    """Update the signs of sensor `i`; return whether it may be broken.

    `motion`: way ahead in m and turn in rad since the last look.
    """
    signs = robot.signs[i]
    value, driven = robot.counts[i], robot.driven
    drove = driven - signs[_DRIVEN]
    signs[_DRIVEN] = driven
    in_range = law.lowest <= value <= law.highest
    signs[_OUT_TICKS] = 0 if in_range else min(signs[_OUT_TICKS] + LOOK_TICKS, RANGE_TICKS)
    _widen(signs, _LOW, _HIGH, value)
    if signs[_HIGH] - signs[_LOW] > STUCK_BAND:
        signs[_LOW] = signs[_HIGH] = value
        signs[STILL_FROM] = driven
    _widen(signs, _QUIET_LOW, _QUIET_HIGH, value)
    before, after = robot.counts[robot.before[i]], robot.counts[robot.after[i]]
    if signs[_QUIET_HIGH] - signs[_QUIET_LOW] > QUIET_COUNTS + QUIET_RATIO * signs[_QUIET_HIGH]:
        signs[_QUIET_LOW] = signs[_QUIET_HIGH] = value
        signs[_BEFORE_LOW] = signs[_BEFORE_HIGH] = before
        signs[_AFTER_LOW] = signs[_AFTER_HIGH] = after
        signs[_LOW_TICKS] = signs[_HIGH_TICKS] = signs[_AGREED_TICKS] = 0
        robot.ways_m[i] = 0.0
    elif drove:
        if signs[_LOW_TICKS] > 0 or signs[_HIGH_TICKS] > 0:
            _widen(signs, _BEFORE_LOW, _BEFORE_HIGH, before)
            _widen(signs, _AFTER_LOW, _AFTER_HIGH, after)
        else:
            signs[_BEFORE_LOW] = signs[_BEFORE_HIGH] = before
            signs[_AFTER_LOW] = signs[_AFTER_HIGH] = after
        high, low = signs[_QUIET_HIGH], signs[_QUIET_LOW]
        second_before, second_after = robot.counts[robot.second_before[i]], robot.counts[robot.second_after[i]]
        if before > high and after > high:
            if high < law.dark_counts and min(before, after) - high > DARK_DIFFERS_COUNTS:
                signs[_LOW_TICKS] += drove
                if min(second_before, second_after) - high > AGREES_COUNTS:
                    signs[_AGREED_TICKS] += drove
        elif low - before > DIFFERS_COUNTS and low - after > DIFFERS_COUNTS:
            signs[_HIGH_TICKS] += drove
            if low - max(second_before, second_after) > DIFFERS_COUNTS:
                _follow_obstacle(robot, i, motion, law)
    still = driven - signs[STILL_FROM] >= law.stuck_ticks
    return bool(signs[_LOW_TICKS] > 0 or signs[_HIGH_TICKS] > 0 or signs[_OUT_TICKS] > 0 or still)


@compiled
def forget_contradictions(robot: Robot) -> None:
    """Forget the contradictions of all sensors with their neighbours, as a resume does (hal.sensor_signs)."""
    for i in range(robot.counts.shape[0]):
        robot.signs[i][_LOW_TICKS] = robot.signs[i][_HIGH_TICKS] = robot.signs[i][_AGREED_TICKS] = 0
        robot.ways_m[i, 0] = robot.ways_m[i, 1] = 0.0


@compiled
def _follow_obstacle(robot: Robot, i: int, motion: tuple[float, float], law: WatchLaw) -> None:
    """Add the way past the obstacle of sensor `i`, by a motion in m and rad (hal.sensor_signs)."""
    signs, beam, (forward_m, turn_rad) = robot.signs[i], law.beams[i], motion
    counts = (signs[_QUIET_LOW] + signs[_QUIET_HIGH]) / 2
    distance_m = law.numerator_counts_m / (counts + law.bias_counts) - law.offset_m
    across_m = forward_m * beam[0] - turn_rad * (beam[2] + distance_m)
    toward_m = turn_rad * beam[3] - forward_m * beam[1]
    robot.ways_m[i, 0] = KEEPS * robot.ways_m[i, 0] + across_m
    robot.ways_m[i, 1] = KEEPS * robot.ways_m[i, 1] + toward_m


@compiled
def _widen(signs: Integers, low: int, high: int, value: int) -> None:
    """Widen a band of `signs` to hold `value`."""
    if value < signs[low]:
        signs[low] = value
    elif value > signs[high]:
        signs[high] = value


@compiled
def _shows_fault(robot: Robot, i: int, law: WatchLaw) -> bool:
    signs = robot.signs[i]
    if signs[_OUT_TICKS] >= RANGE_TICKS or robot.driven - signs[STILL_FROM] >= law.stuck_ticks:
        return True
    if max(abs(robot.ways_m[i, 0]), abs(robot.ways_m[i, 1])) > PASSES_M:
        return True
    before, after = signs[_BEFORE_HIGH] - signs[_BEFORE_LOW], signs[_AFTER_HIGH] - signs[_AFTER_LOW]
    change = (
        before > QUIET_COUNTS + QUIET_RATIO * signs[_BEFORE_HIGH]
        and after > QUIET_COUNTS + QUIET_RATIO * signs[_AFTER_HIGH]
    )
    if signs[_AGREED_TICKS] >= DARK_TICKS or (change and signs[_LOW_TICKS] >= DARK_TICKS):
        return True
    return bool(min(before, after) >= SWING_COUNTS and signs[_HIGH_TICKS] >= PHANTOM_TICKS)


@compiled
def drive_guarded(robot: Robot, wanted: tuple[float, float], now_s: float, limits: GuardLimits) -> None:
    """Move the set points of a robot toward wanted speeds in m/s within the guard's limits, and send CONTROL."""
    present = robot.guarded_left_m_s, robot.guarded_right_m_s
    to_left_m_s, to_right_m_s, from_left_m_s, from_right_m_s, met = _bounded(wanted, present, robot.bumpers, limits)
    elapsed_s = min(now_s - robot.driven_at_s, LONGEST_SLEW_CYCLES * limits.cycle_s)
    left_m_s = _slewed(from_left_m_s, to_left_m_s, elapsed_s, limits)
    right_m_s = _slewed(from_right_m_s, to_right_m_s, elapsed_s, limits)
    if left_m_s != to_left_m_s or right_m_s != to_right_m_s:
        met |= SLEW_LIMIT
    robot.limits = met
    robot.guarded_left_m_s, robot.guarded_right_m_s = left_m_s, right_m_s
    robot.driven_at_s = now_s
    left, right = left_m_s * 100.0, right_m_s * 100.0
    robot.left_cm_s = int(left + math.copysign(_ROUNDING, left))
    robot.right_cm_s = int(right + math.copysign(_ROUNDING, right))
    robot.turned = 1 if robot.left_cm_s != 0 or robot.right_cm_s != 0 else 0
