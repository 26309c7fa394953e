import random
from functools import cache

import pytest

from behaviors.metrics.junctions import QUARTERS, Junctions, JunctionsSettings
from behaviors.metrics.streets import StreetMap
from behaviors.metrics.task_metric import BorderMetric, StretchMetric, TaskMetric
from config.settings import SettingsError
from simbridge.contracts.areas import holds
from simbridge.contracts.simulation import Pose
from tests.behaviors.metrics.paths import Point, along, follow, put
from tests.behaviors.metrics.worlds import course_in
from tests.experiments.helpers import STAGE

SETTINGS = JunctionsSettings(kind="junctions")
ALL = ("straight_on", "turn_left", "turn_right")

# In Manhattan world, streets at 0.4, 2.2, 4.0 and 5.8 each way.
SOUTH_OF_A_CROSSING, CROSSING = (2.2, 1.3), (2.2, 2.2)


@cache
def manhattan() -> StreetMap:
    simulation = STAGE.open("manhattan", 1, "test")
    simulation.close()
    return StreetMap(simulation.plan)


def in_manhattan(behaviours: tuple[str, ...], seed: int = 1) -> TaskMetric:
    return Junctions(manhattan(), behaviours, random.Random(seed))


def set_down(behaviours: tuple[str, ...], at: Point = SOUTH_OF_A_CROSSING, towards_deg: float = 90.0) -> TaskMetric:
    metric = in_manhattan(behaviours)
    put(metric, at, towards_deg)
    return metric


def passed(metric: TaskMetric) -> tuple[float, float]:
    """Junctions that were passed, and those of them that were right."""
    return metric.findings["junctions"], metric.findings["junctions right"]


@pytest.mark.parametrize("way", [[SOUTH_OF_A_CROSSING, (2.2, 1.6)], [SOUTH_OF_A_CROSSING, CROSSING]])
def test_junctions_abort_counts_as_wrong(way: list[Point]) -> None:
    metric = set_down(("turn_left",))
    follow(metric, way)
    assert passed(metric) == (0.0, 0.0)  # nor does it count where the time is over
    metric.abort()
    assert passed(metric) == (1.0, 0.0)


def test_junctions_abort_without_requirement_counts_nothing() -> None:
    metric = set_down(("straight_on",), (2.2, 4.9))  # the northern border ends that street
    metric.abort()
    assert passed(metric) == (0.0, 0.0)
    metric = set_down(("straight_on",), CROSSING)
    metric.abort()
    assert passed(metric) == (0.0, 0.0)


def wandering(seed: int) -> list[Pose]:
    """Return poses of a way through Manhattan that also cuts corners, with all junctions in reach."""
    chance = random.Random(seed)
    points = [(chance.uniform(0.1, 6.1), chance.uniform(0.1, 6.1)) for _ in range(12)]
    return list(along(points, 0.02))


@pytest.mark.parametrize("seed", range(3))
def test_junctions_in_stretches_have_the_bits_of_single_ticks(seed: int) -> None:
    poses = wandering(seed)
    measured = []
    for ticks in (1, 7, 500):
        metric = in_manhattan(ALL, seed)
        assert isinstance(metric, StretchMetric)
        metric.reset(poses[0])
        for begin in range(0, len(poses), ticks):
            metric.update_all(poses[begin : begin + ticks])
        measured.append((metric.progress, dict(metric.findings), metric.behaviour))
    assert measured[0][1]["junctions"] > 0.0
    assert measured[1:] == measured[:1] * 2


def test_junctions_change_the_behaviour_at_their_borders_only() -> None:
    seed = 0
    poses, metric = wandering(seed), in_manhattan(ALL, seed)
    assert isinstance(metric, BorderMetric)
    every, margin_m, areas = metric.borders
    metric.reset(poses[0])
    inside = next((area for area in areas if holds(*poses[0][:2], area, 0.0)), None)
    changes = 0
    for tick, pose in enumerate(poses):
        before, was_inside = (metric.behaviour, metric.needs_reset), inside
        metric.update(pose)
        if tick % every == 0:
            if inside is None:
                inside = next((area for area in areas if holds(*pose[:2], area, 0.0)), None)
            elif not holds(*pose[:2], inside, margin_m):
                inside = None
        changed = (metric.behaviour, metric.needs_reset) != before
        assert not changed or inside is not was_inside
        changes += changed
    assert changes > 0


def test_junctions_refuse_other_worlds_and_behaviours() -> None:
    with pytest.raises(SettingsError, match="junctions: world A"):
        course_in("a", SETTINGS, ALL)
    with pytest.raises(SettingsError, match=", ".join(QUARTERS)):
        course_in("manhattan", SETTINGS, ("",))
