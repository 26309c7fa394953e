"""The loop of a batch: each robot drives some ticks, in the order of events of the loop over the CAN bus."""

from simbridge.batch.compiled import compiled
from simbridge.batch.minds import decide
from simbridge.batch.motion import move, turn_wheels
from simbridge.batch.parts import Integers, Knowledge, Laws, Robot, Robots, World
from simbridge.batch.safety import drive_guarded, is_frozen, looks_broken
from simbridge.batch.sensing import measure
from simbridge.batch.sight import gather, has_moved, may_touch

STAYS, TOUCHES, SLIDES, FROZEN, BROKEN, CROWDED = range(6)
"""Reasons that a robot leaves the batch; 0: it stays."""


@compiled
def drive(active: Integers, ticks: int, robots: Robots, world: World, laws: Laws, knowledge: Knowledge) -> None:
    """Drive the robots of the indexes `active` for so many ticks, or until one leaves the batch."""
    for place in range(active.shape[0]):
        robot = robots[active[place]]
        for k in range(ticks):
            robot.left = run_tick(robot, k, world, laws, knowledge)
            if robot.left != STAYS:
                break


@compiled
def run_tick(robot: Robot, k: int, world: World, laws: Laws, knowledge: Knowledge) -> int:
    """Run tick `k` of the stretch for a robot; return why it must leave the batch, or STAYS."""
    robot.tick += 1
    # The robot's cycle: CONTROL of the tick before, motors, body, sensors.
    turn_wheels(robot, laws)
    if not move(robot, laws.body):
        return SLIDES
    if has_moved(robot) and not gather(robot, world):
        return CROWDED
    if may_touch(robot, world.reach_m, laws.body):
        return TOUCHES
    measure(robot, laws.sensor)
    robot.track_x_m[k], robot.track_y_m[k], robot.track_heading_rad[k] = robot.x_m, robot.y_m, robot.heading_rad
    # The notebook's tick: sense, check, decide, guard.
    now_s = robot.tick * laws.body.cycle_s
    if is_frozen(robot, now_s, laws.watch):
        return FROZEN
    if looks_broken(robot, laws.watch):
        return BROKEN
    wanted = decide(robot, k, laws.mind, knowledge)
    drive_guarded(robot, wanted, now_s, laws.guard)
    return STAYS
