"""Wheels and bodies of a batch: the motors' lag, the slip, and the free motion as the physics engine integrates it."""

import math

from hal.numerics import cos_sin
from simbridge.batch.compiled import compiled
from simbridge.batch.laws import BodyLaw, Laws
from simbridge.batch.record import Robot
from simbridge.robot.wheels import next_speed

_next_speed = compiled(next_speed)
_cos_sin = compiled(cos_sin)


@compiled
def turn_wheels(robot: Robot, laws: Laws) -> None:
    """Simulate one cycle of both motors of a robot towards the set points of its last CONTROL frame."""
    left_told_m_s, right_told_m_s = robot.left_cm_s / 100.0, robot.right_cm_s / 100.0
    robot.left_told_m_s, robot.right_told_m_s = left_told_m_s, right_told_m_s
    robot.left_m_s = _next_speed(robot.left_m_s, left_told_m_s, False, laws.side)
    robot.right_m_s = _next_speed(robot.right_m_s, right_told_m_s, False, laws.side)
    left = robot.left_carry + robot.left_m_s * laws.ticks_per_speed
    right = robot.right_carry + robot.right_m_s * laws.ticks_per_speed
    robot.left_ticks, robot.right_ticks = math.floor(left), math.floor(right)
    robot.left_carry, robot.right_carry = left - robot.left_ticks, right - robot.right_ticks


@compiled
def move(robot: Robot, law: BodyLaw) -> bool:
    """Simulate one cycle of the body of a robot without contacts; return whether its wheels' traction sufficed."""
    used = robot.slip_used
    left_slip = law.slip_keep * robot.left_slip + law.slip_gain * robot.slip_noise[used]
    right_slip = law.slip_keep * robot.right_slip + law.slip_gain * robot.slip_noise[used + 1]
    robot.slip_used = used + 2
    robot.left_slip, robot.right_slip = left_slip, right_slip
    left_m_s = robot.left_m_s * (1.0 + left_slip)
    right_m_s = robot.right_m_s * (1.0 + right_slip)
    forward_m_s = (left_m_s + right_m_s) / 2
    yaw_rad_s = (right_m_s - left_m_s) / law.track_m
    cycle_s, turning_rad_s = law.cycle_s, robot.yaw_rad_s
    vx_m_s, vy_m_s = robot.vx_m_s, robot.vy_m_s
    aim_rad = robot.heading_rad + (turning_rad_s + yaw_rad_s / 2) * cycle_s
    cos, sin = _cos_sin(aim_rad)
    force_x = (forward_m_s * cos - vx_m_s) * law.mass_kg / cycle_s
    force_y = (forward_m_s * sin - vy_m_s) * law.mass_kg / cycle_s
    torque = (yaw_rad_s - turning_rad_s) * law.inertia_kg_m2 / cycle_s
    # The engine moves the body by its old velocity, and changes the velocity then.
    robot.x_m += vx_m_s * cycle_s
    robot.y_m += vy_m_s * cycle_s
    robot.heading_rad += turning_rad_s * cycle_s
    robot.vx_m_s = vx_m_s + force_x * law.inverse_mass * cycle_s
    robot.vy_m_s = vy_m_s + force_y * law.inverse_mass * cycle_s
    robot.yaw_rad_s = turning_rad_s + torque * law.inverse_inertia * cycle_s
    # The traction limit is met only at a wall; its square root is another function in Python than in compiled code.
    limit_n = 0.999 * law.force_limit_n
    return bool(force_x * force_x + force_y * force_y < limit_n * limit_n and abs(torque) < law.torque_limit_n_m)
