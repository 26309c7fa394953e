"""Borders of areas, at which the stretch of a robot ends, because another behaviour may be wanted there."""

from simbridge.batch.compiled import compiled
from simbridge.batch.record import Robot
from simbridge.contracts.areas import Area, holds

OUTSIDE = -1
_holds = compiled(holds)


@compiled
def crosses(robot: Robot) -> bool:
    """Return whether a robot has entered an area, or left its area, in a tick in which its position is looked at."""
    if robot.area_count == 0 or (robot.tick - 1) % robot.area_every != 0:
        return False
    inside = robot.area
    if inside == OUTSIDE or not _is_in(robot, inside, robot.area_margin_m):
        robot.area = area_of(robot) if inside == OUTSIDE else OUTSIDE
    return bool(robot.area != inside)


@compiled
def area_of(robot: Robot) -> int:
    """Return the first area that holds a robot; OUTSIDE if none does."""
    for i in range(robot.area_count):
        if _is_in(robot, i, 0.0):
            return i
    return OUTSIDE


@compiled
def _is_in(robot: Robot, i: int, margin_m: float) -> bool:
    area = Area(robot.areas[i, 0], robot.areas[i, 1], robot.areas[i, 2], robot.areas[i, 3])
    return _holds(robot.x_m, robot.y_m, area, margin_m)
