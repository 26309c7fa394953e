"""Charts and plans of small towns."""

import numpy as np

from kurt2rt.core.planning.plan import Plan, plan_to
from kurt2rt.core.planning.target import FeatureTarget, NearTarget, Target
from kurt2rt.core.planning.topological_map import TopologicalMap
from tests.core.planning.town import SPACE, Town
from tests.core.rla.helpers import withdrawn


def block() -> Town:
    """Four corners; anticlockwise by left turns, and a short cut from the first to the third."""
    town = Town(sw=(0.0, 0.0), se=(2.0, 0.0), ne=(2.0, 2.0), nw=(0.0, 2.0))
    town.way("sw", "turn_left", "se")
    town.way("se", "turn_left", "ne")
    town.way("ne", "turn_left", "nw")
    town.way("nw", "turn_left", "sw")
    return town


def place_id(town: Town, place: str) -> int:
    return town.group_at(town.at(place))[0].rla_id


def meeting(chart: TopologicalMap, target: Target) -> set[int]:
    return {each for each, place in chart.places.items() if target.matches(np.array(place.condition))}


def plan(town: Town, start: str, end: str) -> Plan | None:
    chart = town.chart()
    target = NearTarget(tuple(town.at(end).tolist()), SPACE.radius, town.distance, town.group_at)
    return plan_to(chart, place_id(town, start), meeting(chart, target))


def actions(found: Plan | None) -> list[str]:
    assert found is not None
    return [way.action for way in found.edges]


def test_a_plan_is_a_chain_of_ways_that_were_never_gone_one_after_the_other() -> None:
    found = plan(block(), "se", "sw")
    assert actions(found) == ["turn_left", "turn_left", "turn_left"]
    assert found is not None
    assert found.ticks == 2400.0


def test_of_two_chains_the_quicker_one_is_planned() -> None:
    town = block()
    town.way("sw", "straight_on", "ne", ticks=1500.0)
    assert actions(plan(town, "sw", "ne")) == ["straight_on"]
    assert actions(plan(town, "sw", "nw")) == ["straight_on", "turn_left"]


def test_a_way_that_often_leads_elsewhere_costs_the_tries() -> None:
    town = block()
    risky = town.way("sw", "straight_on", "ne", ticks=1500.0)
    town.follow_ups[risky, place_id(town, "ne")] = 3
    town.follow_ups[risky, place_id(town, "nw")] = 7
    assert actions(plan(town, "sw", "ne")) == ["turn_left", "turn_left"]


def test_where_nothing_leads_there_is_no_plan() -> None:
    town = Town(home=(0.0, 0.0), door=(2.0, 0.0))
    town.way("door", "straight_on", "home")
    town.teach("home", "straight_on")  # taught, but never gone: nobody knows where it leads
    assert plan(town, "home", "door") is None


def test_who_is_there_has_nothing_to_go() -> None:
    found = plan(block(), "ne", "ne")
    assert found is not None
    assert found.next is None


def test_a_goal_may_lie_where_nothing_was_taught_yet() -> None:
    town = block()
    town.places["yard"] = (4.0, 0.0)
    town.way("se", "straight_on", "yard")
    assert actions(plan(town, "sw", "yard")) == ["turn_left", "straight_on"]


def test_what_followed_tells_where_an_rla_leads_when_its_expectation_lies_between_two_places() -> None:
    town = block()
    torn = town.way("sw", "straight_on", "ne")
    town.seen[torn] = town.seen[torn]._replace(mean=np.array([1.0, 1.0, 0.0]))
    town.follow_ups[torn, place_id(town, "ne")] = 1
    town.follow_ups[torn, place_id(town, "nw")] = 1
    chart, here = town.chart(), place_id(town, "sw")
    ways = [chart.edge(here, place_id(town, each)) for each in ("ne", "nw")]
    assert {way.rla_id for way in ways} == {torn}
    assert {(way.end, way.share) for way in ways} == {(place_id(town, "ne"), 0.5), (place_id(town, "nw"), 0.5)}


def test_a_partial_goal_is_the_nearest_place_that_has_it() -> None:
    town = block()
    town.walled = {"ne", "nw"}
    fresh = Town(**town.places)
    fresh.walled = town.walled
    for start, end in (("sw", "se"), ("se", "ne"), ("ne", "nw")):
        fresh.way(start, "turn_left", end)
    fresh.teach("nw", "turn_left")
    chart = fresh.chart()
    goals = meeting(chart, FeatureTarget({2: 1.0}, 0.1))
    assert goals == {place_id(fresh, "ne"), place_id(fresh, "nw")}
    found = plan_to(chart, place_id(fresh, "sw"), goals)
    assert actions(found) == ["turn_left", "turn_left"]


def test_an_rla_that_lost_its_action_is_no_way() -> None:
    town = block()
    rla_id = place_id(town, "se")
    town.system.apply(withdrawn(rla_id, "turn_left"))
    assert plan_to(town.chart(), place_id(town, "sw"), {place_id(town, "ne")}) is None
