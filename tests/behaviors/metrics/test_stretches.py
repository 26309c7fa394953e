"""Metrics that take many ticks at once: the same bits as tick by tick."""

from collections.abc import Callable

import pytest

from behaviors.metrics.eights import Eights, EightsSettings
from behaviors.metrics.rounds import Rounds, RoundsSettings
from behaviors.metrics.task_metric import StretchMetric
from behaviors.metrics.way import Way
from simbridge.contracts.simulation import Pose, SimulatedPost
from tests.behaviors.metrics.paths import Point, follow_in_stretches, noisy_poses

WEST, EAST = (1.8, 1.8), (3.1, 1.8)


def way() -> StretchMetric:
    return Way(Pose(0.0, 0.0, 0.0), "")


def rounds() -> StretchMetric:
    settings = RoundsSettings(kind="rounds", wanted_m=0.3, within_m=0.5, turning="right")
    return Rounds(settings, SimulatedPost("post", *WEST, 0.05), "")


def eights() -> StretchMetric:
    settings = EightsSettings(kind="eights", wanted_m=0.45)
    return Eights(settings, SimulatedPost("west", *WEST, 0.2), SimulatedPost("east", *EAST, 0.2), "")


def measured(metric: StretchMetric, poses: list[Pose], ticks: int) -> tuple[float, dict[str, float]]:
    metric.reset(poses[0])
    if ticks:
        follow_in_stretches(metric, poses[1:], ticks)
    else:
        for pose in poses[1:]:
            metric.update(pose)
    return metric.progress, dict(metric.findings)


@pytest.mark.parametrize("centre", [WEST, (2.45, 1.8)])
@pytest.mark.parametrize("build", [way, rounds, eights])
def test_metric_of_stretches_has_the_bits_of_single_ticks(build: Callable[[], StretchMetric], centre: Point) -> None:
    for seed in range(2):
        poses = noisy_poses(centre, seed)
        expected = measured(build(), poses, 0)
        assert expected[0] != 0.0 or build is eights
        assert [measured(build(), poses, ticks) for ticks in (1, 7, 500)] == [expected] * 3
