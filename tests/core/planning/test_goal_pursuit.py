"""Pursuit of a goal: plan, surprise, arrival, missing path."""

import numpy as np

from kurt2rt.core.decision.decision import GoalStatus
from kurt2rt.core.decision.goal import Goal, NamedGoal, PartialGoal, RlaGoal
from kurt2rt.core.planning.goal_pursuit import PIECES, GoalPursuit
from kurt2rt.core.planning.target import Target, Vector, make_target
from kurt2rt.core.planning.topological_map import build_map
from kurt2rt.core.rla.rla import MID, Rla
from tests.core.planning.town import FEATURES, SPACE, Town
from tests.core.rla.helpers import named


def grid() -> Town:
    """Three places in a row and two above, with ways east and north."""
    town = Town(a=(0.0, 0.0), b=(2.0, 0.0), c=(4.0, 0.0), d=(2.0, 2.0), e=(4.0, 2.0))
    town.way("a", "straight_on", "b")
    town.way("b", "straight_on", "c")
    town.way("b", "turn_left", "d", ticks=900.0)
    town.way("c", "turn_left", "e")
    town.way("d", "turn_right", "e")
    town.teach("e", "straight_on")
    return town


def target(town: Town, goal: Goal) -> Target:
    if "e" in town.places and "door" not in town.system.named_situations(MID):
        town.system.apply(named("door", tuple(town.at("e").tolist()), MID))
    return make_target(goal, town.system, FEATURES, SPACE, town.distance, town.group_at)


DOOR = NamedGoal("door")


def seeking(town: Town, goal: Goal = DOOR) -> GoalPursuit:
    seeks = GoalPursuit(town.build_map, town.group_at)
    seeks.seek(goal, target(town, goal))
    return seeks


def think(seeks: GoalPursuit) -> int:
    """Plan until the status is settled; return the number of ticks."""
    ticks = 0
    while seeks.status is GoalStatus.PLANNING:
        seeks.plan_step()
        ticks += 1
    return ticks


def arrive(seeks: GoalPursuit, situation: Vector) -> int:
    seeks.arrive(situation)
    return think(seeks)


def course(seeks: GoalPursuit) -> GoalStatus:
    return seeks.status


def chosen(town: Town, seeks: GoalPursuit, place: str) -> str | None:
    rla = seeks.choose(town.group_at(town.at(place)))
    return None if rla is None else rla.action


def test_pursuit_other_place_is_surprise_and_new_plan() -> None:
    town = grid()
    seeks = seeking(town)
    arrive(seeks, town.at("a"))
    arrive(seeks, town.at("b"))
    arrive(seeks, town.at("d"))  # the robot turned where it was to go straight on
    assert seeks.surprises == 1
    assert chosen(town, seeks, "d") == "turn_right"
    arrive(seeks, town.at("e"))
    assert course(seeks) is GoalStatus.ARRIVED


def test_pursuit_unknown_place_is_lost() -> None:
    town = grid()
    seeks = seeking(town)
    arrive(seeks, town.at("a"))
    arrive(seeks, np.array([9.0, 9.0, 0.0]))
    assert course(seeks) is GoalStatus.LOST
    assert seeks.choose(town.group_at(town.at("a"))) is None
    arrive(seeks, town.at("b"))  # led back
    assert course(seeks) is GoalStatus.UNDER_WAY


def test_pursuit_replan_uses_new_edge() -> None:
    town = grid()
    seeks = seeking(town, RlaGoal(1))
    arrive(seeks, town.at("e"))
    assert course(seeks) is GoalStatus.NO_WAY
    town.way("e", "turn_left", "a")
    seeks.replan(town.at("e"))
    assert course(seeks) is GoalStatus.PLANNING
    assert seeks.stands  # where it stood without a way it stands until there is one
    think(seeks)
    assert not seeks.stands
    assert course(seeks) is GoalStatus.UNDER_WAY
    assert chosen(town, seeks, "e") == "turn_left"


def test_pursuit_false_goal_place_is_rejected() -> None:
    town = grid()
    town.walled = {"c", "d"}
    fresh = Town(**town.places)
    fresh.walled = town.walled
    fresh.way("a", "straight_on", "b")
    fresh.way("b", "straight_on", "c")
    fresh.way("b", "turn_left", "d", ticks=900.0)
    fresh.way("c", "turn_right", "a")
    fresh.teach("d", "straight_on")
    goal = PartialGoal((("wall_left", 1.0),), tolerance=0.1)
    seeks = seeking(fresh, goal)
    arrive(seeks, fresh.at("a"))
    arrive(seeks, fresh.at("b"))
    assert chosen(fresh, seeks, "b") == "straight_on"
    without_wall = np.array([4.0, 0.0, 0.0])
    arrive(seeks, without_wall)
    assert course(seeks) is GoalStatus.UNDER_WAY
    assert chosen(fresh, seeks, "c") == "turn_right"
    arrive(seeks, fresh.at("a"))
    arrive(seeks, fresh.at("b"))
    assert chosen(fresh, seeks, "b") == "turn_left"
    arrive(seeks, fresh.at("d"))
    assert course(seeks) is GoalStatus.ARRIVED


def test_pursuit_without_goal_chooses_none() -> None:
    town = grid()
    seeks = seeking(town)
    arrive(seeks, town.at("a"))
    seeks.stop()
    arrive(seeks, town.at("b"))
    assert course(seeks) is GoalStatus.NONE
    assert seeks.text == ""
    assert chosen(town, seeks, "b") is None
    assert not seeks.stands


def test_pursuit_large_town_plans_over_many_ticks() -> None:
    row = Town(**{f"p{number}": (2.0 * number, 0.0) for number in range(200)})
    for number in range(199):
        row.way(f"p{number}", "straight_on", f"p{number + 1}")
    last = PartialGoal((("x_m", 398.0),), tolerance=0.1)
    matched = 0

    def group_at(situation: Vector) -> tuple[Rla, ...]:
        nonlocal matched
        matched += 1
        return row.group_at(situation)

    took = []
    for _ in range(2):
        seeks = GoalPursuit(lambda: build_map(row.system.rlas_at(MID), group_at, row.followed, row.seen.get), group_at)
        seeks.seek(last, target(row, last))
        seeks.arrive(row.at("p0"))
        ticks = most = 0
        while seeks.status is GoalStatus.PLANNING:
            matched = 0
            seeks.plan_step()
            ticks, most = ticks + 1, max(most, matched)
        assert most <= PIECES
        took.append(ticks)
    assert took[0] == took[1]
    assert took[0] > 2 * 200 // PIECES
    assert len(seeks.plan) == 199


def test_target_lost_robot_never_matches() -> None:
    town = grid()
    nowhere = np.array([np.nan, np.nan, 1.0])
    for goal in (DOOR, PartialGoal((("wall_left", 1.0),))):
        assert not target(town, goal)(nowhere)
        seeks = seeking(town, goal)
        arrive(seeks, nowhere)
        assert course(seeks) is GoalStatus.LOST
