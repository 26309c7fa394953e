from functools import cache

import pytest

from behaviors.metrics.junctions import QUARTERS
from behaviors.metrics.route import FixedRoute, RouteSettings
from behaviors.metrics.routes import Leg, Route
from behaviors.metrics.streets import StreetMap
from behaviors.metrics.task_metric import RouteMetric
from hal.settings import SettingsError
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
    course = FixedRoute(streets(), route or a_route(), ALL)
    course.reset(course.reset_pose)
    return course


def middle(leg: Leg) -> Point:
    return leg.middle.x_m, leg.middle.y_m


def corner(leg: Leg) -> Point:
    return leg.junction.x_m, leg.junction.y_m


def drive(course: FixedRoute, legs: int) -> None:
    """Follow the route for `legs` legs, from the middle of the present street."""
    all_legs = course.route.legs
    for _ in range(legs):
        leg, following = (all_legs[(course.ahead.passed + k) % len(all_legs)] for k in (0, 1))
        follow(course, [middle(leg), corner(leg), middle(following)])


def wrong_way(leg: Leg) -> Point:
    """Return the middle of a street that leads out of a leg's junction and is not on the route."""
    junction = leg.junction
    side = next(each for each in sorted(junction.arms) if each not in (leg.leaves, leg.way.turned(2)))
    along = {0: (0.9, 0.0), 1: (0.0, 0.9), 2: (-0.9, 0.0), 3: (0.0, -0.9)}[side]
    return junction.x_m + along[0], junction.y_m + along[1]


def with_a_choice(course: FixedRoute) -> None:
    """Drive on to where another way than the route's is possible."""
    while len(course.route.legs[course.ahead.passed % 8].junction.arms) < 3:
        drive(course, 1)


def test_route_begins_in_the_middle_of_the_first_street() -> None:
    course = set_down()
    assert isinstance(course, RouteMetric)
    assert course.reset_pose == course.route.legs[0].middle
    assert MEANING[course.behaviour] == course.route.quarters[0]
    passed, inside, here, after = course.ahead
    assert (passed, inside, here, MEANING[after]) == (0, False, course.behaviour, course.route.quarters[1])


def test_route_without_errors_counts_every_decision_right() -> None:
    course = set_down()
    asked = []
    for _ in range(16):
        asked.append(MEANING[course.behaviour])
        drive(course, 1)
    assert tuple(asked) == course.route.quarters * 2
    assert course.progress == course.findings["junctions"] == course.findings["junctions right"] == 16.0
    lefts = float(2 * course.route.quarters.count(1))
    assert course.findings["junctions, turn_left"] == course.findings["junctions right, turn_left"] == lefts
    assert course.ahead.passed == 16
    assert not course.needs_reset


def test_route_wrong_way_counts_and_resets_to_the_right_street() -> None:
    course = set_down()
    with_a_choice(course)
    place = course.ahead.passed
    leg = course.route.legs[place]
    follow(course, [middle(leg), corner(leg), wrong_way(leg)])
    assert course.needs_reset
    assert course.passages[-1].taken != leg.quarters
    assert course.reset_pose == course.route.legs[(place + 1) % 8].middle
    course.reset(course.reset_pose)
    assert not course.needs_reset
    drive(course, 3)
    assert course.findings["junctions"] - course.findings["junctions right"] == 1.0
    assert course.progress == place + 3.0


def test_route_turning_back_counts_as_wrong_and_repeats() -> None:
    course = set_down()
    drive(course, 1)
    follow(course, [middle(course.route.legs[1]), corner(course.route.legs[0])])
    assert course.needs_reset
    assert course.passages[-1].taken is None
    assert course.reset_pose == course.route.legs[1].middle
    course.reset(course.reset_pose)
    drive(course, 1)
    assert (course.progress, course.findings["junctions"]) == (2.0, 3.0)


def test_route_reset_repeats_a_street_and_skips_a_junction() -> None:
    course = set_down()
    first, second = course.route.legs[:2]
    assert course.reset_pose == first.middle
    course.reset(course.reset_pose)
    assert course.passages == []
    follow(course, [middle(first), corner(first)])
    assert course.reset_pose == second.middle
    course.reset(course.reset_pose)
    assert [each.taken for each in course.passages] == [None]
    assert (course.ahead.passed, course.ahead.inside) == (1, False)


def test_route_abort_counts_as_wrong() -> None:
    course = set_down()
    drive(course, 2)
    course.abort()
    assert (course.progress, course.findings["junctions"]) == (2.0, 3.0)


def test_route_refuses_other_worlds_behaviours_and_numbers() -> None:
    settings = RouteSettings(kind="route")
    with pytest.raises(SettingsError, match="route: world A"):
        course_in("a", settings, ALL)
    with pytest.raises(SettingsError, match=", ".join(QUARTERS)):
        course_in("manhattan", settings, ("",))
    with pytest.raises(SettingsError, match="7 decisions"):
        course_in("manhattan", RouteSettings(kind="route", decisions=7), ALL)
