"""Counts of a robot's whole drive: questions, collisions, distance, and whether it is stuck."""

import math

from simbridge.batch.compiled import compiled
from simbridge.batch.laws import StuckLaw
from simbridge.batch.record import Robot

TRAIL_TICKS = 10
"""Ticks between two positions of the travelled distance."""


@compiled
def count_tick(robot: Robot, asked: bool, law: StuckLaw) -> None:
    """Count the present tick of a robot.

    `asked`: whether the robot asked in the tick before.
    """
    if robot.action < 0:
        robot.unknown_ticks += 1
        if not asked:
            robot.questions += 1
            if robot.first_question == 0:
                robot.first_question = robot.tick
    if robot.collisions > 0 and robot.first_collision == 0:
        robot.first_collision = robot.tick
    if robot.tick % TRAIL_TICKS == 0:
        if robot.tick > TRAIL_TICKS:
            dx, dy = robot.x_m - robot.mark_x_m, robot.y_m - robot.mark_y_m
            robot.travelled_m += math.sqrt(dx * dx + dy * dy)
        robot.mark_x_m, robot.mark_y_m = robot.x_m, robot.y_m
    if law.positions > 0 and (robot.tick - 1) % law.every_ticks == 0:
        robot.stuck = _stays(robot, law)


@compiled
def _stays(robot: Robot, law: StuckLaw) -> bool:
    """Keep the position of a robot, and return whether it stayed near it for a whole window."""
    place = robot.kept % law.positions
    robot.kept_x_m[place], robot.kept_y_m[place] = robot.x_m, robot.y_m
    robot.kept += 1
    if robot.kept < law.positions:
        return False
    for i in range(law.positions):
        dx, dy = robot.x_m - robot.kept_x_m[i], robot.y_m - robot.kept_y_m[i]
        if not dx * dx + dy * dy < law.least_m * law.least_m:
            return False
    return True
