"""The loop of a batch: each robot drives some ticks, in the order of events of the loop over the CAN bus."""

import math

from hal.numerics import cos_sin
from simbridge.batch.borders import area_of, crosses
from simbridge.batch.compiled import compiled
from simbridge.batch.contacts import keep_box, leave_engine
from simbridge.batch.decisions import COMMANDED, decide
from simbridge.batch.laws import Averages, BodyLaw, Integers, Knowledge, Laws, World
from simbridge.batch.record import BROKEN, CROWDED, FROZEN, STAYS, Robot, Robots, count_tick
from simbridge.batch.safety import drive_guarded, is_frozen, looks_broken
from simbridge.batch.sensing import measure, measure_all
from simbridge.batch.sight import gather, has_moved, may_touch
from simbridge.robot.wheels import next_speed

_next_speed = compiled(next_speed)
_cos_sin = compiled(cos_sin)


@compiled
def turn_wheels(robot: Robot, laws: Laws) -> None:
    """Simulate one cycle of both motors towards the last CONTROL's set points (simbridge.robot.wheels)."""
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
    """Simulate one cycle of a robot's body without contacts; return whether its wheels' traction sufficed.

    If not, the physics engine has to move it in this tick.
    """
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


@compiled
def drive(
    active: Integers,
    ticks: int,
    robots: Robots,
    world: World,
    laws: Laws,
    knowledge: Knowledge,
    averages: Averages,
) -> None:
    """Drive the robots of the indexes `active` to the end of a stretch of so many ticks.

    A robot ends sooner that leaves the batch, is stuck, crosses a border, or waits for the physics engine. A robot that
    waits has been moved by the engine, and finishes its tick first.
    """
    for place in range(active.shape[0]):
        robot = robots[active[place]]
        while robot.at < ticks and robot.left == STAYS and not robot.stuck and not robot.crossed:
            if robot.waits:
                leave_engine(robot, laws.body)
            else:
                begin_tick(robot, world, laws)
            if robot.waits:
                break
            if robot.left == STAYS:
                finish_tick(robot, world, laws, knowledge, averages)


@compiled
def begin_tick(robot: Robot, world: World, laws: Laws) -> None:
    """Run the robot's cycle up to its new pose: CONTROL of the tick before, motors, body.

    Sets `waits` if the body may touch something, so that the physics engine has to move it.
    """
    robot.tick += 1
    k = robot.at
    robot.last_x_m, robot.last_y_m, robot.last_heading_rad = robot.x_m, robot.y_m, robot.heading_rad
    robot.last_vx_m_s, robot.last_vy_m_s = robot.vx_m_s, robot.vy_m_s
    robot.track_told_cm_s[k, 0], robot.track_told_cm_s[k, 1] = robot.left_cm_s, robot.right_cm_s
    turn_wheels(robot, laws)
    if robot.engine_ticks > 0:
        robot.slip_used += 2
        robot.waits = 1
        return
    grips = move(robot, laws.body)
    if has_moved(robot) and not gather(robot, world):
        robot.left = CROWDED
        return
    if not grips or may_touch(robot, world.reach_m, laws.body):
        robot.waits = 1
        return
    keep_box(robot, laws.body)
    robot.bumpers = robot.touching = 0
    robot.free_cycles += 1


@compiled
def finish_tick(robot: Robot, world: World, laws: Laws, knowledge: Knowledge, averages: Averages) -> None:
    """Run the rest of a tick from the robot's new pose: sensors; then sense, check, decide, guard of the notebook."""
    if sense_tick(robot, world, laws):
        wanted = decide(robot, robot.at, laws.mind, knowledge, averages)
        drive_guarded(robot, wanted, robot.tick * laws.body.cycle_s, laws.guard)
        count_tick(robot, laws.stuck)
        if robot.kind == COMMANDED:
            trace(robot, robot.at)
        robot.crossed = crosses(robot)
        robot.at += 1


@compiled
def sense_tick(robot: Robot, world: World, laws: Laws) -> bool:
    """Run a tick from the robot's new pose up to the notebook's check of its sensors; return whether it stays."""
    if has_moved(robot) and not gather(robot, world):
        robot.left = CROWDED
        return False
    measure(robot, laws.sensor)
    k = robot.at
    robot.track_x_m[k], robot.track_y_m[k], robot.track_heading_rad[k] = robot.x_m, robot.y_m, robot.heading_rad
    robot.track_collisions[k] = robot.collisions
    if is_frozen(robot, robot.tick * laws.body.cycle_s, laws.watch):
        robot.left = FROZEN
    elif looks_broken(robot, laws.watch):
        robot.left = BROKEN
    return bool(robot.left == STAYS)


@compiled
def put_down(robot: Robot, world: World, laws: Laws) -> bool:
    """Let a robot stand at the pose where it was put: wheels still, sensors settled, nothing touched.

    Return whether the engine makes a new box around its body, so that what was before does not matter.
    """
    robot.last_vx_m_s = robot.last_vy_m_s = 0.0
    robot.vx_m_s = robot.vy_m_s = robot.yaw_rad_s = 0.0
    robot.left_m_s = robot.right_m_s = robot.left_carry = robot.right_carry = 0.0
    robot.bumpers = robot.touching = 0
    robot.area = area_of(robot)
    if has_moved(robot) and not gather(robot, world):
        robot.left = CROWDED
        return False
    measure_all(robot, laws.sensor)
    return keep_box(robot, laws.body)


@compiled
def trace(robot: Robot, k: int) -> None:
    """Store the readings and guard limits of a commanded robot in tick `k`, for `Trace`."""
    for i in range(robot.counts.shape[0]):
        robot.track_counts[k, i] = robot.counts[i]
    robot.track_left_ticks[k], robot.track_right_ticks[k] = robot.left_ticks, robot.right_ticks
    robot.track_bumpers[k], robot.track_limits[k] = robot.bumpers, robot.limits
