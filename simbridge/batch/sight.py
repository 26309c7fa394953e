"""Rays and contacts of a batch: the nearest face or post along a ray, and whether a body may touch one."""

import math

from hal.numerics import cos_sin
from simbridge.batch.compiled import compiled
from simbridge.batch.laws import BodyLaw, World
from simbridge.batch.record import NEAR_FACES, NEAR_POSTS, Robot

MARGIN_M = 0.25
"""Extra range of near faces, so that they serve until the robot has moved by it."""
_CORNER = 1e-9
"""Tolerance that keeps a ray from slipping between the two faces of a corner (simbridge.robot.ray_caster)."""
_TOUCH_M = 1e-5
"""A body that is nearer to a wall than this may touch it."""
_cos_sin = compiled(cos_sin)


@compiled
def away2_m2(dx: float, dy: float, edge_x: float, edge_y: float) -> float:
    """Return the squared distance in m2 from a point to a face: all in m, as seen from the face's corner."""
    along = (dx * edge_x + dy * edge_y) / (edge_x * edge_x + edge_y * edge_y)
    along = min(max(along, 0.0), 1.0)
    away_x, away_y = dx - along * edge_x, dy - along * edge_y
    return away_x * away_x + away_y * away_y


@compiled
def gather(robot: Robot, world: World) -> bool:
    """Keep the faces and posts near a robot, for rays and contacts; return False if they are too many."""
    x_m, y_m, place = robot.x_m, robot.y_m, robot.world
    keep_m = world.reach_m + MARGIN_M + 1e-6
    faces = posts = 0
    for i in range(world.face_count[place]):
        edge_x, edge_y = world.faces[place, i, 2], world.faces[place, i, 3]
        dx, dy = x_m - world.faces[place, i, 0], y_m - world.faces[place, i, 1]
        if away2_m2(dx, dy, edge_x, edge_y) <= keep_m * keep_m:
            if faces == NEAR_FACES:
                return False
            for k in range(4):
                robot.near[faces, k] = world.faces[place, i, k]
            faces += 1
    for i in range(world.post_count[place]):
        dx, dy = x_m - world.posts[place, i, 0], y_m - world.posts[place, i, 1]
        reach_m = keep_m + world.posts[place, i, 2]
        if dx * dx + dy * dy <= reach_m * reach_m:
            if posts == NEAR_POSTS:
                return False
            for k in range(4):
                robot.posts[posts, k] = world.posts[place, i, k]
            posts += 1
    robot.near_count, robot.post_count = faces, posts
    robot.gathered_x_m, robot.gathered_y_m = x_m, y_m
    robot.free_m = 0.0
    return True


@compiled
def has_moved(robot: Robot) -> bool:
    """Return whether a robot has moved so far since `gather` that other faces may be near."""
    dx, dy = robot.x_m - robot.gathered_x_m, robot.y_m - robot.gathered_y_m
    return not dx * dx + dy * dy <= MARGIN_M * MARGIN_M


@compiled
def cast(robot: Robot, start: tuple[float, float], along: tuple[float, float], farthest_m: float) -> float:
    """Return the distance in m from a point along a unit vector to the nearest wall, at most `farthest_m`."""
    x_m, y_m = start
    along_x, along_y = along
    nearest_m = farthest_m
    for i in range(robot.near_count):
        edge_x, edge_y = robot.near[i, 2], robot.near[i, 3]
        across = along_x * edge_y - along_y * edge_x
        if across == 0.0:
            continue
        dx, dy = robot.near[i, 0] - x_m, robot.near[i, 1] - y_m
        away_m = (dx * edge_y - dy * edge_x) / across
        if 0.0 <= away_m < nearest_m and -_CORNER <= (dx * along_y - dy * along_x) / across <= 1.0 + _CORNER:
            nearest_m = away_m
    for i in range(robot.post_count):
        dx, dy = robot.posts[i, 0] - x_m, robot.posts[i, 1] - y_m
        ahead_m = dx * along_x + dy * along_y
        half_chord2 = robot.posts[i, 3] - (dx * dx + dy * dy - ahead_m * ahead_m)
        if ahead_m > 0.0 and half_chord2 >= 0.0:
            nearest_m = min(nearest_m, max(0.0, ahead_m - math.sqrt(half_chord2)))
    return nearest_m


@compiled
def may_touch(robot: Robot, reach_m: float, law: BodyLaw) -> bool:
    """Return whether the body of a robot may touch something; False proves that it does not."""
    x_m, y_m = robot.x_m, robot.y_m
    dx, dy = x_m - robot.free_x_m, y_m - robot.free_y_m
    if dx * dx + dy * dy < robot.free_m * robot.free_m:
        return False
    round_m = math.sqrt(law.half_length_m * law.half_length_m + law.half_width_m * law.half_width_m) + 2 * _TOUCH_M
    least_m = MARGIN_M + reach_m
    for i in range(robot.near_count):
        dx, dy = x_m - robot.near[i, 0], y_m - robot.near[i, 1]
        least_m = min(least_m, math.sqrt(away2_m2(dx, dy, robot.near[i, 2], robot.near[i, 3])))
    for i in range(robot.post_count):
        dx, dy = x_m - robot.posts[i, 0], y_m - robot.posts[i, 1]
        least_m = min(least_m, math.sqrt(dx * dx + dy * dy) - robot.posts[i, 2])
    # Faces beyond the near ones may have come nearer by as much as the robot moved since they were gathered.
    robot.free_x_m, robot.free_y_m = x_m, y_m
    robot.free_m = max(0.0, min(least_m, reach_m) - round_m)
    return least_m <= round_m and _box_meets(robot, law)


@compiled
def _box_meets(robot: Robot, law: BodyLaw) -> bool:
    """Return whether the box of a robot, a little enlarged, meets a near face or post."""
    cos, sin = _cos_sin(robot.heading_rad)
    half_x_m, half_y_m = law.half_length_m + _TOUCH_M, law.half_width_m + _TOUCH_M
    for i in range(robot.near_count):
        dx, dy = robot.near[i, 0] - robot.x_m, robot.near[i, 1] - robot.y_m
        edge_x, edge_y = robot.near[i, 2], robot.near[i, 3]
        first = (dx * cos + dy * sin, dy * cos - dx * sin)
        edge = (edge_x * cos + edge_y * sin, edge_y * cos - edge_x * sin)
        if _crosses_box(first, edge, half_x_m, half_y_m):
            return True
    for i in range(robot.post_count):
        dx, dy = robot.posts[i, 0] - robot.x_m, robot.posts[i, 1] - robot.y_m
        out_x = max(0.0, abs(dx * cos + dy * sin) - half_x_m)
        out_y = max(0.0, abs(dy * cos - dx * sin) - half_y_m)
        if out_x * out_x + out_y * out_y <= robot.posts[i, 3]:
            return True
    return False


@compiled
def _crosses_box(first: tuple[float, float], edge: tuple[float, float], half_x_m: float, half_y_m: float) -> bool:
    """Return whether a segment from a point along an edge meets a box around the origin."""
    enter, leave = 0.0, 1.0
    for axis in range(2):
        start, step = (first[0], edge[0]) if axis == 0 else (first[1], edge[1])
        half_m = half_x_m if axis == 0 else half_y_m
        if abs(step) < 1e-12:
            if abs(start) > half_m:
                return False
            continue
        one, other = (-half_m - start) / step, (half_m - start) / step
        enter, leave = max(enter, min(one, other)), min(leave, max(one, other))
    return enter <= leave
