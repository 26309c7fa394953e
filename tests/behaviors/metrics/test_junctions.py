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
WAYS_ON: dict[str, Point] = {"straight_on": (2.2, 3.1), "turn_left": (1.3, 2.2), "turn_right": (3.1, 2.2)}


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


@pytest.mark.parametrize("behaviour", ALL)
@pytest.mark.parametrize("taken", ALL)
def test_junctions_required_side_counts_as_right(behaviour: str, taken: str) -> None:
    metric = set_down((behaviour,))
    follow(metric, [SOUTH_OF_A_CROSSING, CROSSING, WAYS_ON[taken]])
    assert passed(metric) == (1.0, float(taken == behaviour))
    assert metric.progress == float(taken == behaviour)
    assert metric.behaviour == behaviour


def test_a_junction_is_passed_only_once_it_is_left_behind() -> None:
    metric = set_down(("turn_left",))
    follow(metric, [SOUTH_OF_A_CROSSING, CROSSING, (1.75, 2.2)])  # out of its square, which ends at 1.8
    assert passed(metric) == (0.0, 0.0)
    follow(metric, [(1.75, 2.2), (1.65, 2.2)])
    assert passed(metric) == (1.0, 1.0)


def test_junctions_turning_back_counts_as_wrong() -> None:
    metric = set_down(("turn_left",))
    follow(metric, [SOUTH_OF_A_CROSSING, (2.2, 1.7), (2.2, 0.9)])
    assert passed(metric) == (0.0, 0.0)  # it may turn again
    follow(metric, [(2.2, 0.9), (2.2, 0.5)])  # but it came to the junction in the south
    assert passed(metric) == (1.0, 0.0)
    follow(metric, [(2.2, 0.5), (2.2, 0.4), (3.1, 0.4)])  # where it turns left, as it is still asked to
    assert passed(metric) == (2.0, 1.0)


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


def test_junctions_behaviour_changes_after_each_junction() -> None:
    metric = set_down(ALL, (1.3, 0.4), 0.0)  # along the southern border: streets go on ahead and to the left
    asked = []
    for x_m in (1.3, 3.1):
        asked.append(metric.behaviour)
        follow(metric, [(x_m, 0.4), (x_m + 1.8, 0.4)])
    assert set(asked) <= {"straight_on", "turn_left"}
    assert metric.behaviour == "turn_left"  # nothing else is possible at the corner
    follow(metric, [(4.9, 0.4), (5.8, 0.4), (5.8, 1.3)])
    findings = metric.findings
    assert (findings["junctions"], findings["junctions right"]) == (3.0, 1.0 + asked.count("straight_on"))
    assert findings["junctions, turn_left"] == 1.0 + asked.count("turn_left")
    assert findings["junctions right, turn_left"] == 1.0
    assert findings["junctions, turn_right"] == 0.0


def test_junctions_straight_on_at_a_t_needs_reset() -> None:
    metric = set_down(("straight_on",), (2.2, 4.9))  # the northern border ends that street
    follow(metric, [(2.2, 4.9), (2.2, 5.3)])
    assert not metric.needs_reset
    follow(metric, [(2.2, 5.3), (2.2, 5.6)])
    assert metric.needs_reset
    put(metric, SOUTH_OF_A_CROSSING, 90.0)
    assert not metric.needs_reset
    follow(metric, [SOUTH_OF_A_CROSSING, CROSSING, WAYS_ON["straight_on"]])
    assert passed(metric) == (1.0, 1.0)


def test_junctions_after_turning_back_require_a_possible_way() -> None:
    metric = set_down(ALL, (4.9, 0.4), 180.0)  # towards a T, with streets ahead and to the right
    follow(metric, [(4.9, 0.4), (5.0, 0.4), (5.5, 0.4)])  # but it came to the corner, where only a left turn is left
    assert metric.behaviour == "turn_left"
    assert not metric.needs_reset


def test_lateral_deviation_counts_in_streets_only() -> None:
    metric = set_down(("straight_on",))
    follow(metric, [(2.25, 0.9), (2.25, 1.7)])
    assert metric.findings["lateral deviation, m"] == pytest.approx(0.05, abs=0.002)
    follow(metric, [(2.5, 1.9), (2.5, 2.5)])  # within the junction
    assert metric.findings["lateral deviation, m"] == pytest.approx(0.05, abs=0.002)


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
