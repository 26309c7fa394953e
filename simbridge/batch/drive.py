"""The loop of a batch: each robot drives some ticks, in the order of events of the loop over the CAN bus."""

from simbridge.batch.borders import area_of, crosses
from simbridge.batch.boxes import keep_box, meet_box
from simbridge.batch.compiled import compiled
from simbridge.batch.laws import Averages, Integers, Knowledge, Laws, World
from simbridge.batch.minds import COMMANDED, decide
from simbridge.batch.motion import move, turn_wheels
from simbridge.batch.record import BROKEN, CROWDED, FROZEN, STAYS, Robot, Robots
from simbridge.batch.safety import drive_guarded, is_frozen, looks_broken
from simbridge.batch.sensing import measure, measure_all
from simbridge.batch.sight import gather, has_moved, may_touch
from simbridge.batch.tally import count_tick


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

    A robot ends sooner that leaves the batch, is stuck, crosses a border, or waits for the physics engine.
    """
    for place in range(active.shape[0]):
        robot = robots[active[place]]
        while robot.at < ticks and robot.left == STAYS and not robot.stuck and not robot.crossed:
            begin_tick(robot, world, laws)
            if robot.waits:
                break
            if robot.left == STAYS:
                finish_tick(robot, world, laws, knowledge, averages)


@compiled
def begin_tick(robot: Robot, world: World, laws: Laws) -> None:
    """Run the robot's cycle up to its new pose: CONTROL of the tick before, motors, body."""
    robot.tick += 1
    k = robot.at
    robot.last_x_m, robot.last_y_m, robot.last_heading_rad = robot.x_m, robot.y_m, robot.heading_rad
    robot.last_vx_m_s, robot.last_vy_m_s = robot.vx_m_s, robot.vy_m_s
    robot.track_left_cm_s[k], robot.track_right_cm_s[k] = robot.left_cm_s, robot.right_cm_s
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
    """Enter the readings of a commanded robot in tick `k` of the stretch, and the limits that its guard met."""
    for i in range(robot.counts.shape[0]):
        robot.track_counts[k, i] = robot.counts[i]
    robot.track_left_ticks[k], robot.track_right_ticks[k] = robot.left_ticks, robot.right_ticks
    robot.track_bumpers[k], robot.track_limits[k] = robot.bumpers, robot.limits


@compiled
def finish_waiting(r: int, robots: Robots, world: World, laws: Laws, knowledge: Knowledge, averages: Averages) -> None:
    """Run the rest of a tick for robot `r`, whose body the physics engine has moved."""
    robot = robots[r]
    robot.waits = 0
    meet_box(robot, laws.body)
    finish_tick(robot, world, laws, knowledge, averages)
