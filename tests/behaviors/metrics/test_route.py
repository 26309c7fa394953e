from functools import cache

import pytest

from behaviors.metrics.junctions import QUARTERS
from behaviors.metrics.route import FixedRoute, RouteSettings
from behaviors.metrics.routes import Leg, Route
from behaviors.metrics.streets import StreetMap
from config.settings import SettingsError
from tests.behaviors.metrics.paths import Point, follow
from tests.behaviors.metrics.worlds import course_in
from tests.experiments.helpers import STAGE

ALL = ("straight_on", "turn_left", "turn_right")
MEANING = dict(zip(ALL, (0, 1, -1), strict=True))


@cache
def streets() -> StreetMap:
    return StreetMap(STAGE.plan_of("manhattan"))


def a_route(seed: int = 1, decisions: int = 8) -> Route:
    return RouteSettings(kind="route", decisions=decisions, seed=seed).route_in(STAGE.plan_of("manhattan"), ALL)


def set_down(route: Route | None = None) -> FixedRoute:
    metric = FixedRoute(streets(), route or a_route(), ALL)
    metric.reset(metric.reset_pose)
    return metric


def middle(leg: Leg) -> Point:
    return leg.middle.x_m, leg.middle.y_m


def corner(leg: Leg) -> Point:
    return leg.junction.x_m, leg.junction.y_m


def drive(metric: FixedRoute, legs: int) -> None:
    """Follow the route for `legs` legs, from the middle of the present street."""
    all_legs = metric.route.legs
    for _ in range(legs):
        leg, following = (all_legs[(metric.ahead.passed + k) % len(all_legs)] for k in (0, 1))
        follow(metric, [middle(leg), corner(leg), middle(following)])


def test_route_without_errors_counts_every_decision_right() -> None:
    metric = set_down()
    asked = []
    for _ in range(16):
        asked.append(MEANING[metric.behaviour])
        drive(metric, 1)
    assert tuple(asked) == metric.route.quarters * 2
    assert metric.progress == metric.findings["junctions"] == metric.findings["junctions right"] == 16.0
    lefts = float(2 * metric.route.quarters.count(1))
    assert metric.findings["junctions, turn_left"] == metric.findings["junctions right, turn_left"] == lefts
    assert metric.ahead.passed == 16
    assert not metric.needs_reset


def test_route_turning_back_counts_as_wrong_and_repeats() -> None:
    metric = set_down()
    drive(metric, 1)
    follow(metric, [middle(metric.route.legs[1]), corner(metric.route.legs[0])])
    assert metric.needs_reset
    assert metric.passages[-1].taken is None
    assert metric.reset_pose == metric.route.legs[1].middle
    metric.reset(metric.reset_pose)
    drive(metric, 1)
    assert (metric.progress, metric.findings["junctions"]) == (2.0, 3.0)


def test_route_reset_repeats_a_street_and_skips_a_junction() -> None:
    metric = set_down()
    first, second = metric.route.legs[:2]
    assert metric.reset_pose == first.middle
    metric.reset(metric.reset_pose)
    assert metric.passages == []
    follow(metric, [middle(first), corner(first)])
    assert metric.reset_pose == second.middle
    metric.reset(metric.reset_pose)
    assert [each.taken for each in metric.passages] == [None]
    assert (metric.ahead.passed, metric.ahead.inside) == (1, False)


def test_route_abort_counts_as_wrong() -> None:
    metric = set_down()
    drive(metric, 2)
    metric.abort()
    assert (metric.progress, metric.findings["junctions"]) == (2.0, 3.0)


def test_route_refuses_other_worlds_behaviours_and_numbers() -> None:
    settings = RouteSettings(kind="route")
    with pytest.raises(SettingsError, match="route: world A"):
        course_in("a", settings, ALL)
    with pytest.raises(SettingsError, match=", ".join(QUARTERS)):
        course_in("manhattan", settings, ("",))
    with pytest.raises(SettingsError, match="7 decisions"):
        course_in("manhattan", RouteSettings(kind="route", decisions=7), ALL)
