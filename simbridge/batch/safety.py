"""Guard's limits and watches of a batch, for robots that nothing disturbs.

Readings are always fresh and no other node sends CONTROL, so only bumpers, the limits of speed and slew, the watch for
frozen boards and the watch for single broken sensors can act. The watch of the wheels cannot: a sound motor stays
within its band (tests/simbridge/batch/test_laws.py).
"""

import math

from hal.guard_limits import GuardLimits, limited, slewed
from hal.sensor_signs import (
    LOOK_TICKS,
    Beam,
    compare_with_neighbours,
    fault_code,
    forget_contradictions,
    obstacle_motion_m,
    update_signs,
    widen,
)
from simbridge.batch.compiled import compiled
from simbridge.batch.laws import WatchLaw
from simbridge.batch.record import Robot

_ROUNDING = 1e-6
"""Set points are truncated to whole cm/s beyond this (hal.control)."""

_limited = compiled(limited, slewed)
_forget = compiled(forget_contradictions)
_compare = compiled(compare_with_neighbours, widen, obstacle_motion_m)
_update_signs = compiled(update_signs, widen, forget_contradictions, compare_with_neighbours=_compare)
_fault_code = compiled(fault_code)


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
        before, after = robot.counts[robot.before[i]], robot.counts[robot.after[i]]
        second_before, second_after = robot.counts[robot.second_before[i]], robot.counts[robot.second_after[i]]
        readings = robot.counts[i], before, after, second_before, second_after
        beam = Beam(law.beams[i, 0], law.beams[i, 1], law.beams[i, 2], law.beams[i, 3])
        signs = robot.signs[i]
        if _update_signs(signs, robot.ways_m[i], readings, robot.driven, motion, beam, law.sensors, True):
            found = found or _fault_code(signs, robot.driven, law.sensors) > 0
    return found


@compiled
def forget_all_contradictions(robot: Robot) -> None:
    """Forget the contradictions of all sensors with their neighbours, as a resume does (hal.sensor_watch)."""
    for i in range(robot.counts.shape[0]):
        _forget(robot.signs[i], robot.ways_m[i])


@compiled
def drive_guarded(robot: Robot, wanted: tuple[float, float], now_s: float, limits: GuardLimits) -> None:
    """Move the set points of a robot toward wanted speeds in m/s within the guard's limits, and send CONTROL."""
    present, elapsed_s = (robot.guarded_left_m_s, robot.guarded_right_m_s), now_s - robot.driven_at_s
    left_m_s, right_m_s, robot.limits = _limited(wanted, present, robot.bumpers, elapsed_s, limits)
    robot.guarded_left_m_s, robot.guarded_right_m_s = left_m_s, right_m_s
    robot.driven_at_s = now_s
    left, right = left_m_s * 100.0, right_m_s * 100.0
    robot.left_cm_s = int(left + math.copysign(_ROUNDING, left))
    robot.right_cm_s = int(right + math.copysign(_ROUNDING, right))
    robot.turned = 1 if robot.left_cm_s != 0 or robot.right_cm_s != 0 else 0
