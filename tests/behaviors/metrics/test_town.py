"""Streets as one goes through them, and the shortest ways among them."""

import math

import pytest

from behaviors.metrics.errands import ErrandsSettings
from behaviors.metrics.streets import Side
from behaviors.metrics.town import Street, Town, length_m
from hal.kurt2_settings import load_kurt2
from kurt2rt.core.task_settings import load_task
from simbridge.contracts.simulation import Pose
from simbridge.simulation import Kurt2SimulationFactory

BEHAVIOURS = ("straight_on", "turn_left", "turn_right")
PLAN = Kurt2SimulationFactory(load_kurt2()).plan_of("manhattan")
METRIC = load_task("errands").metric


@pytest.fixture(scope="module")
def town() -> Town:
    assert isinstance(METRIC, ErrandsSettings)
    return METRIC.walk_in(PLAN, BEHAVIOURS).town


def street(town: Town, x_m: float, y_m: float, way: Side) -> Street:
    found = town.street_at(Pose(x_m, y_m, way.heading_rad))
    assert found is not None
    return found


def test_ways_are_measured_from_where_one_is_to_where_one_comes(town: Town) -> None:
    way = town.shortest(street(town, 1.3, 2.2, Side.EAST), street(town, 2.2, 3.1, Side.NORTH))
    assert way is not None
    assert length_m(way) == pytest.approx(1.8)
    assert length_m(way, Pose(1.9, 2.2, 0.0), Pose(2.2, 2.8, math.pi / 2)) == pytest.approx(0.9)


def test_tracker_lists_streets_once_and_marks_resets() -> None:
    assert isinstance(METRIC, ErrandsSettings)
    walk = METRIC.walk_in(PLAN, BEHAVIOURS)
    walk.reset(Pose(1.3, 2.2, 0.0))
    for x_m in (1.5, 1.8, 2.2, 2.6, 2.75, 3.0):
        walk.update(Pose(x_m, 2.2, 0.0))
    walk.reset(Pose(1.3, 2.2, 0.0))
    first, second = street(walk.town, 1.3, 2.2, Side.EAST), street(walk.town, 3.1, 2.2, Side.EAST)
    assert walk.streets == [None, first, second, None, first]
    assert walk.progress == 1.0
