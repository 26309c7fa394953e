"""Box that the physics engine keeps around a body (Chipmunk's cpBBTree): it tells when the list of near walls is new.

In the step in which the body leaves its box, the engine makes a wider one and meets the walls in another order than in
later steps. So a body can go on from such a step as if it had driven all the way, and only from there.
"""

import math

from simbridge.batch.compiled import compiled
from simbridge.batch.laws import BodyLaw
from simbridge.batch.record import Robot

_WIDER = 0.1
"""Part of a box's size by which the engine's box is wider, and time in s of the velocity that it foresees."""


@compiled
def keep_box(robot: Robot, law: BodyLaw) -> bool:
    """Make a new box if the body has left the one before; return whether it has. Call it at the end of a tick."""
    cos, sin = math.cos(robot.heading_rad), math.sin(robot.heading_rad)
    left, lower, right, upper = math.inf, math.inf, -math.inf, -math.inf
    for corner in range(4):
        ahead_m = law.half_length_m if corner < 2 else -law.half_length_m
        aside_m = law.half_width_m if corner % 2 == 0 else -law.half_width_m
        x_m = cos * ahead_m - sin * aside_m + robot.x_m
        y_m = sin * ahead_m + cos * aside_m + robot.y_m
        left, right = min(left, x_m), max(right, x_m)
        lower, upper = min(lower, y_m), max(upper, y_m)
    box = robot.box
    if box[0] <= left and box[1] <= lower and box[2] >= right and box[3] >= upper:
        return False
    wide, high = (right - left) * _WIDER, (upper - lower) * _WIDER
    foreseen_x_m, foreseen_y_m = robot.last_vx_m_s * _WIDER, robot.last_vy_m_s * _WIDER
    box[0], box[1] = left + min(-wide, foreseen_x_m), lower + min(-high, foreseen_y_m)
    box[2], box[3] = right + max(wide, foreseen_x_m), upper + max(high, foreseen_y_m)
    _keep_state(robot)
    return True


@compiled
def meet_box(robot: Robot, law: BodyLaw) -> None:
    """Keep the box of a body that the engine itself has moved in this tick."""
    keep_box(robot, law)
    robot.box_is_new = 0


@compiled
def _keep_state(robot: Robot) -> None:
    """Remember the state of the body in which the engine makes its box."""
    robot.box_is_new, robot.box_tick = 1, robot.tick
    state = robot.box_state
    state[0], state[1], state[2] = robot.x_m, robot.y_m, robot.heading_rad
    state[3], state[4] = robot.last_vx_m_s, robot.last_vy_m_s
    state[5], state[6], state[7] = robot.vx_m_s, robot.vy_m_s, robot.yaw_rad_s
    state[8], state[9] = robot.left_slip, robot.right_slip
    state[10], state[11] = robot.left_m_s, robot.right_m_s
