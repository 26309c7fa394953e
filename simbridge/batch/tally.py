"""Counts of a robot's whole drive: questions, collisions, distance, and whether it is stuck."""

import math

from hal.open_question import question_ticks
from simbridge.batch.compiled import compiled
from simbridge.batch.laws import StuckLaw
from simbridge.batch.record import Robot

TRAIL_TICKS = 10
"""Ticks between two positions of the travelled distance."""
_question_ticks = compiled(question_ticks)


@compiled
def count_tick(robot: Robot, law: StuckLaw) -> None:
    """Count the present tick of a robot."""
    asks = robot.action < 0
    begins = asks and robot.question_left == 0
    robot.question_left = _question_ticks(robot.question_left, asks, robot.sure != 0, robot.turned != 0)
    robot.track_begins[robot.at] = 1 if begins else 0
    robot.unknown_ticks += 1 if asks else 0
    if begins:
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
    if law.positions > 0 and (robot.tick - robot.kept_since) % law.every_ticks == 0:
        robot.stuck = _stays(robot, law)


@compiled
def restart_window(robot: Robot, law: StuckLaw) -> None:
    """End the question and begin a new window of the rule of being stuck: the robot was put elsewhere in this tick."""
    robot.kept, robot.kept_since, robot.stuck, robot.question_left = 0, robot.tick, 0, 0
    if law.positions > 0:
        _stays(robot, law)


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
