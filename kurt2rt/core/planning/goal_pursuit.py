"""Pursuit of a goal: plan, follow the plan, plan again after a surprise, and report a missing path."""

import heapq
from collections.abc import Callable, Collection

from kurt2rt.core.decision.decision import GoalStatus
from kurt2rt.core.decision.goal import Goal, goal_text
from kurt2rt.core.planning.target import GroupAt, Target, Vector
from kurt2rt.core.planning.topological_map import Edge, MapBuild, MapBuilder, TopologicalMap
from kurt2rt.core.rla.rla import Rla

PIECES = 16
"""RLAs and places processed in one tick of planning; each takes 30 to 60 us."""


_STANDING = {
    GoalStatus.ARRIVED: GoalStatus.ARRIVED,
    GoalStatus.NO_WAY: GoalStatus.NO_WAY,
    GoalStatus.LOST: GoalStatus.NO_WAY,
}
"""Reason of the standstill by each status in which the robot stands."""


Plan = tuple[Edge, ...]
"""Way from the present place to the goal: edges of the topological map in driving order."""


def plan_to(topological_map: TopologicalMap, start: int, goals: Collection[int]) -> Plan | None:
    """Return the cheapest plan from a place to one of the goals (Dijkstra).

    Returns None if no path exists, or if the map lacks `start`. `start` and `goals`: ids of places.
    """
    if start not in topological_map.places:
        return None
    costs, last = _cheapest_edges(topological_map, start)
    reached = [goal for goal in goals if goal in costs]
    if not reached:
        return None
    place = min(reached, key=lambda goal: (costs[goal], goal))
    edges = []
    while place != start:
        edges.append(last[place])
        place = last[place].start
    return tuple(reversed(edges))


def _cheapest_edges(topological_map: TopologicalMap, start: int) -> tuple[dict[int, float], dict[int, Edge]]:
    """Return the cost of each reachable place and the last edge of its cheapest path; the first found path wins a tie.

    Own code: networkx takes 17 MB, more than any other package of a robot but numpy.
    """
    costs: dict[int, float] = {}
    last: dict[int, Edge] = {}
    cheapest = {start: 0.0}
    waiting = [(0.0, 0, start)]
    pushed = 0
    while waiting:
        cost, _, place = heapq.heappop(waiting)
        if place in costs:
            continue
        costs[place] = cost
        for edge in topological_map.edges_from(place):
            total = cost + edge.cost
            if edge.end not in cheapest or total < cheapest[edge.end]:
                cheapest[edge.end], last[edge.end] = total, edge
                pushed += 1
                heapq.heappush(waiting, (total, pushed, edge.end))
    return costs, last


class GoalPursuit:
    """Goal of the `Navigator` and the plan that leads there, changed at junctions and by commands.

    Planning is spread over ticks and counted in RLAs and places, not in time, so that a replay is equal.
    """

    def __init__(self, begin_map: Callable[[], MapBuild], group_at: GroupAt) -> None:
        """`begin_map`: starts the map of a new plan. `group_at`: RLAs on a place; empty if the mid level would ask."""
        self._begin_map = begin_map
        self._group_at = group_at
        self._target: Target | None = None
        self._map_builder: MapBuilder | None = None
        """Map under construction; None unless planning."""
        self._here = 0
        """Start place of the plan."""
        self._begun = False
        """Return whether the first tick has passed, whose events may still remove expectations: it builds nothing."""
        self._map_done = False
        """Return whether the map is complete; the search runs alone in the next tick."""
        self._stood_before: GoalStatus | None = None
        """Reason of a standstill at the beginning of planning."""
        self._lost_meaning = ""
        """Reason that the goal cannot be resolved any more; empty if it can."""
        self._planned_on: TopologicalMap | None = None
        self._next_place: frozenset[int] = frozenset()
        """Ids of the RLAs on the next place of the plan."""
        self._rejected_goals: set[int] = set()
        """Places that matched the goal on the map, but not when the robot arrived."""
        self.goal: Goal | None = None
        self.status = GoalStatus.NONE
        self.plan: Plan = ()
        """Rest of the plan, whose first edge is being driven; empty without one."""
        self.surprises = 0
        """Number of arrivals at another place than planned, for this goal."""

    @property
    def stands(self) -> bool:
        """Return whether the robot stands because of the goal."""
        return self.standing_status is not None

    @property
    def standing_status(self) -> GoalStatus | None:
        """Reason of the standstill, ARRIVED or NO_WAY; None while it drives."""
        if self.status in _STANDING:
            return _STANDING[self.status]
        return self._stood_before if self.status is GoalStatus.PLANNING else None

    @property
    def text(self) -> str:
        """Status in a few words; empty without a goal."""
        if self.goal is None:
            return ""
        if self.status is GoalStatus.NO_WAY and self._lost_meaning:
            return f"{self.goal.text} cannot be gone to any more: {self._lost_meaning}"
        if not self.plan or self.status is not GoalStatus.UNDER_WAY:
            return goal_text(self.status, self.goal.text)
        edge, left = self.plan[0], len(self.plan)
        ways = "1 way" if left == 1 else f"{left} ways"
        return f"on the way to {self.goal.text}: {ways} left, now {edge.action} (RLA {edge.rla_id})"

    def seek(self, goal: Goal, target: Target) -> None:
        """Set the goal and the target that tells when it is reached; the next `arrive` begins the plan."""
        self._stood_before = self.standing_status
        self.goal, self._target = goal, target
        self._lost_meaning = ""
        self._rejected_goals.clear()
        self._map_builder, self.plan = None, ()
        self.status = GoalStatus.UNDER_WAY
        self.surprises = 0

    def retarget(self, target: Target) -> None:
        """Replace the target after the knowledge changed; the goal stays."""
        self._target = target

    def give_up(self, because: str) -> None:
        """Stand until another goal is set, because this one cannot be resolved any more.

        `because`: reason in a few words, for `text`.
        """
        self._target = None
        self._lost_meaning = because
        self._settle(GoalStatus.NO_WAY)

    def stop(self) -> None:
        """Drop the goal and the plan, so that the robot does not stand because of them."""
        self.goal = self._target = None
        self._settle(GoalStatus.NONE)

    def arrive(self, situation: Vector) -> None:
        """Process the arrival in a situation (d,): at the goal, at the planned place, or elsewhere."""
        if self._target is None or self.status is GoalStatus.ARRIVED:
            return
        if self._target(situation):
            self._settle(GoalStatus.ARRIVED)
            return
        group = self._group_at(situation)
        if self.plan:
            rest = self.plan[1:]
            ids = {rla.rla_id for rla in group}
            as_planned = not ids.isdisjoint(self._next_place)
            self.surprises += not as_planned
            if as_planned and rest and rest[0].rla_id in ids:
                self._follow(rest)
                return
        self._plan_from(group)

    def replan(self, situation: Vector) -> None:
        """Plan again from a situation (d,), because the knowledge changed."""
        self.plan = ()
        self.arrive(situation)

    def choose(self, group: tuple[Rla, ...]) -> Rla | None:
        """Return the RLA of the group that the plan uses; None if the plan uses none."""
        return next((rla for rla in group if self.plan and rla.rla_id == self.plan[0].rla_id), None)

    def plan_step(self) -> bool:
        """Do one tick of planning; return whether planning has ended."""
        builder = self._map_builder
        if builder is None:
            return False
        if not self._begun:
            self._begun = True
            return False
        if not self._map_done:
            self._map_done = builder.step(PIECES)
            return False
        topological_map, goals = builder.topological_map, builder.goals
        assert topological_map is not None
        if self._here in goals:
            self._rejected_goals.add(self._here)
        plan = plan_to(topological_map, self._here, goals - self._rejected_goals)
        self._settle(GoalStatus.NO_WAY if plan is None else GoalStatus.UNDER_WAY)
        if plan is not None:
            self._planned_on = topological_map
            self._follow(plan)
        return True

    def _plan_from(self, group: tuple[Rla, ...]) -> None:
        assert self._target is not None
        if not group:
            self._settle(GoalStatus.LOST)
            return
        self._stood_before = self._stood_before or self.standing_status
        self.status, self.plan = GoalStatus.PLANNING, ()
        self._map_builder = MapBuilder(self._begin_map(), self._target)
        self._begun = self._map_done = False
        self._here = group[0].rla_id

    def _settle(self, status: GoalStatus) -> None:
        self.status = status
        self._map_builder = self._stood_before = None
        self.plan = ()

    def _follow(self, plan: Plan) -> None:
        self.plan = plan
        assert self._planned_on is not None
        self._next_place = self._planned_on.members(plan[0].end)
