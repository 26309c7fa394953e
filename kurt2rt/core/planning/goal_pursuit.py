"""Going to a goal: plan, follow the plan, plan anew when surprised, and say so where there is no way."""

from collections.abc import Callable

from kurt2rt.core.decision.goal import Goal
from kurt2rt.core.decision.plan_step import GoalStatus
from kurt2rt.core.planning.map_builder import MapBuilder
from kurt2rt.core.planning.plan import Plan, plan_to
from kurt2rt.core.planning.target import GroupAt, Target, Vector
from kurt2rt.core.planning.topological_map import MapBuild, TopologicalMap
from kurt2rt.core.rla.rla import Rla

PIECES = 16
"""RLAs and places that are looked at in one tick, for a plan; each takes 30 to 60 us."""


class GoalPursuit:
    """Where the robot is to go, and the plan to get there. Changes at junction events only, and when it is told to.

    A plan is made over several ticks, counted in RLAs and places, so that no tick waits for it, and the same run is the
    same again.
    """

    def __init__(self, build_map: Callable[[], MapBuild], group_at: GroupAt) -> None:
        """`build_map`: begins a chart of what is known and expected now; asked for when a plan is.

        `group_at` knows no place where the mid level would ask, so no plan drives there either.
        """
        self._begin_map = build_map
        self._group_at = group_at
        self._target: Target | None = None
        self._map_builder: MapBuilder | None = None
        """While a plan is being made: what has been looked at for it."""
        self._here = 0
        """The place that it begins at."""
        self._begun = False
        """The tick that begins a plan may still hear of what an RLA leads to no more: it looks at nothing."""
        self._map_done = False
        """Whether the survey is done; the search has the next tick for itself."""
        self._stood_before: GoalStatus | None = None
        """How the robot stood when the plan was begun."""
        self._lost_meaning = ""
        """Why the goal means nothing any more."""
        self._planned_on: TopologicalMap | None = None
        self._next_place: frozenset[int] = frozenset()
        """RLAs on the place that the plan leads to next."""
        self._rejected_goals: set[int] = set()
        """Places that looked like the goal on the chart, and were not when the robot came there."""
        self.goal: Goal | None = None
        self.status = GoalStatus.NONE
        self.plan: Plan | None = None
        """What is left of it; its first way is the one that is being gone."""
        self.surprises = 0
        """How often the robot came to another place than planned, since this goal was given."""

    @property
    def stands(self) -> bool:
        """Whether the robot stands: it has arrived, sees no way, is lost, or was so when it began to plan."""
        return self.stands_as is not None

    @property
    def stands_as(self) -> GoalStatus | None:
        """Why the robot stands: at a goal, or without a way; None where it does not."""
        match self.status:
            case GoalStatus.ARRIVED:
                return GoalStatus.ARRIVED
            case GoalStatus.NO_WAY | GoalStatus.LOST:
                return GoalStatus.NO_WAY
            case GoalStatus.PLANNING:
                return self._stood_before
        return None

    @property
    def text(self) -> str:
        """How it stands, in a few words; empty while there is no goal."""
        if self.goal is None:
            return ""
        match self.status:
            case GoalStatus.ARRIVED:
                return f"arrived: {self.goal.text}"
            case GoalStatus.PLANNING:
                return f"planning the way to {self.goal.text}"
            case GoalStatus.NO_WAY if self._lost_meaning:
                return f"{self.goal.text} cannot be gone to any more: {self._lost_meaning}"
            case GoalStatus.NO_WAY:
                return f"no way from here to {self.goal.text}: nothing taught leads there"
            case GoalStatus.LOST:
                return f"lost on the way to {self.goal.text}: this place is not known; answer here, or set it down"
        left = 0 if self.plan is None else len(self.plan.edges)
        way = None if self.plan is None else self.plan.next
        if way is None:
            return f"on the way to {self.goal.text}: the plan begins behind the next junction"
        ways = "1 way" if left == 1 else f"{left} ways"
        return f"on the way to {self.goal.text}: {ways} left, now {way.action} (RLA {way.rla_id})"

    def seek(self, goal: Goal, target: Target) -> None:
        """Go there from now on; the plan is begun at the next `arrive`."""
        self._stood_before = self.stands_as
        self.goal, self._target = goal, target
        self._lost_meaning = ""
        self._rejected_goals.clear()
        self._map_builder = self.plan = None
        self.status = GoalStatus.UNDER_WAY
        self.surprises = 0

    def retarget(self, target: Target) -> None:
        """The same goal, as it is told from other situations by what is known now."""
        self._target = target

    def give_up(self, because: str) -> None:
        """The goal means nothing any more: the robot stands, until there is another one, or none."""
        self._target = None
        self._lost_meaning = because
        self._settle(GoalStatus.NO_WAY)

    def stop(self) -> None:
        """No goal any more."""
        self.goal = self._target = None
        self._settle(GoalStatus.NONE)

    def arrive(self, situation: Vector) -> None:
        """The robot has come to a place: is it the goal, or where the plan leads to, and how does it go on?"""
        if self._target is None or self.status is GoalStatus.ARRIVED:
            return
        if self._target.matches(situation):
            self._settle(GoalStatus.ARRIVED)
            return
        group = self._group_at(situation)
        if self.plan is not None and self.plan.next is not None:
            rest = self.plan.after_first()
            ids = {rla.rla_id for rla in group}
            as_planned = not ids.isdisjoint(self._next_place)
            self.surprises += not as_planned
            if as_planned and rest.next is not None and rest.next.rla_id in ids:
                self._follow(rest)
                return
        self._plan_from(group)

    def replan(self, situation: Vector) -> None:
        """What is known has changed: plan from here."""
        self.plan = None
        self.arrive(situation)

    def choose(self, group: tuple[Rla, ...]) -> Rla | None:
        """Of the RLAs on the place where the robot is, the one that the plan goes by; None where it has no opinion."""
        way = None if self.plan is None else self.plan.next
        if way is None:
            return None
        return next((rla for rla in group if rla.rla_id == way.rla_id), None)

    def plan_step(self) -> bool:
        """A tick's share of the work on a plan; whether that has settled how it goes on."""
        survey = self._map_builder
        if survey is None:
            return False
        if not self._begun:
            self._begun = True
            return False
        if not self._map_done:
            self._map_done = survey.step(PIECES)
            return False
        chart, goals = survey.topological_map, survey.goals
        assert chart is not None
        if self._here in goals:
            self._rejected_goals.add(self._here)
        plan = plan_to(chart, self._here, goals - self._rejected_goals)
        self._settle(GoalStatus.NO_WAY if plan is None else GoalStatus.UNDER_WAY)
        if plan is not None:
            self._planned_on = chart
            self._follow(plan)
        return True

    def defer_plan(self) -> None:
        """The plan came too late for this junction: it is made anew behind it."""
        self.plan = None

    def _plan_from(self, group: tuple[Rla, ...]) -> None:
        assert self._target is not None
        if not group:
            self._settle(GoalStatus.LOST)
            return
        self._stood_before = self._stood_before or self.stands_as
        self.status, self.plan = GoalStatus.PLANNING, None
        self._map_builder = MapBuilder(self._begin_map(), self._target)
        self._begun = self._map_done = False
        self._here = group[0].rla_id

    def _settle(self, course: GoalStatus) -> None:
        self.status = course
        self._map_builder = self.plan = self._stood_before = None

    def _follow(self, plan: Plan) -> None:
        self.plan = plan
        assert self._planned_on is not None
        assert plan.next is not None
        self._next_place = self._planned_on.members(plan.next.end)
