"""Ways through a world, drawn by hand."""

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise

from behaviors.metrics.task_metric import TaskMetric
from hal.simulation import Pose

Point = tuple[float, float]
STEP_M = 0.004


def along(points: Sequence[Point], step_m: float = STEP_M) -> Iterator[Pose]:
    """Poses from point to point, one a tick unless it is said how far apart, looking ahead."""
    for (ax, ay), (bx, by) in pairwise(points):
        heading_rad = math.atan2(by - ay, bx - ax)
        steps = max(1, round(math.dist((ax, ay), (bx, by)) / step_m))
        for k in range(1, steps + 1):
            yield Pose(ax + (bx - ax) * k / steps, ay + (by - ay) * k / steps, heading_rad)


def arc(centre: Point, radius_m: float, from_deg: float, to_deg: float) -> list[Point]:
    """Points of an arc; counter-clockwise when the angle grows."""
    steps = max(2, round(abs(to_deg - from_deg) / 2))
    angles = [math.radians(from_deg + (to_deg - from_deg) * k / steps) for k in range(steps + 1)]
    return [(centre[0] + radius_m * math.cos(angle), centre[1] + radius_m * math.sin(angle)) for angle in angles]


def put(course: TaskMetric, at: Point, towards_deg: float) -> None:
    course.reset(Pose(*at, math.radians(towards_deg)))


def follow(course: TaskMetric, points: Sequence[Point]) -> None:
    """Drive there; stops where the course says that the robot is needs_reset."""
    for pose in along(points):
        course.update(pose)
        if course.needs_reset:
            return
