"""Ways through a world, drawn by hand."""

import math
import random
from collections.abc import Iterator, Sequence
from itertools import pairwise

from behaviors.metrics.task_metric import StretchMetric, TaskMetric
from simbridge.contracts.simulation import Pose

Point = tuple[float, float]
STEP_M = 0.004


def along(points: Sequence[Point], step_m: float = STEP_M) -> Iterator[Pose]:
    """Poses from point to point, one a tick unless it is said how far apart, looking ahead."""
    for (ax, ay), (bx, by) in pairwise(points):
        heading_rad = math.atan2(by - ay, bx - ax)
        steps = max(1, round(math.dist((ax, ay), (bx, by)) / step_m))
        for k in range(1, steps + 1):
            yield Pose(ax + (bx - ax) * k / steps, ay + (by - ay) * k / steps, heading_rad)


def put(metric: TaskMetric, at: Point, towards_deg: float) -> None:
    metric.reset(Pose(*at, math.radians(towards_deg)))


def follow(metric: TaskMetric, points: Sequence[Point]) -> None:
    """Drive there; stops where the metric says that the robot is needs_reset."""
    for pose in along(points):
        metric.update(pose)
        if metric.needs_reset:
            return


def follow_in_stretches(metric: StretchMetric, poses: Sequence[Pose], ticks: int) -> None:
    """Drive along poses, so many ticks at once."""
    for begin in range(0, len(poses), ticks):
        metric.update_all(poses[begin : begin + ticks])


def noisy_poses(centre: Point, seed: int, ticks: int = 3000) -> list[Pose]:
    """Poses of a drive that wanders about a point, nearer and farther, to and fro."""
    chance, poses, angle_rad, away_m, way = random.Random(seed), [], 0.0, 0.6, 1.0
    for _ in range(ticks):
        way = -way if chance.random() < 0.003 else way
        angle_rad += way * chance.uniform(0.0, 0.03)
        away_m = min(2.0, max(0.3, away_m + chance.gauss(0.0, 0.02)))
        poses.append(
            Pose(centre[0] + away_m * math.cos(angle_rad), centre[1] + away_m * math.sin(angle_rad), angle_rad)
        )
    return poses


def _on_circle(centre: Point, radius_m: float, angle_rad: float) -> Point:
    return centre[0] + radius_m * math.cos(angle_rad), centre[1] + radius_m * math.sin(angle_rad)
