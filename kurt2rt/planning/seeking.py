"""Going to a goal: plan, follow the plan, plan anew when surprised, and say so where there is no way."""

from collections.abc import Callable

from kurt2rt.planning.chart import Chart
from kurt2rt.planning.goal import Goal
from kurt2rt.planning.plan import Plan, plan_to
from kurt2rt.planning.step import Course
from kurt2rt.planning.target import GroupAt, Target, Vector
from kurt2rt.rla.rla import Rla


class Seeking:
    """Where the robot is to go, and the plan to get there. Changes at junction events only, and when it is told to."""

    def __init__(self, chart: Callable[[], Chart], group_at: GroupAt) -> None:
        """`chart`: of what is known and expected now, made when a plan is.

        `group_at` knows no place where the mid level would ask, so no plan drives there either.
        """
        self._chart = chart
        self._group_at = group_at
        self._target: Target | None = None
        self._planned_on: Chart | None = None
        self._next_place: frozenset[int] = frozenset()
        """RLAs on the place that the plan leads to next."""
        self._disappointed: set[int] = set()
        """Places that looked like the goal on the chart, and were not when the robot came there."""
        self.goal: Goal | None = None
        self.course = Course.NONE
        self.plan: Plan | None = None
        """What is left of it; its first way is the one that is being gone."""
        self.surprises = 0
        """How often the robot came to another place than planned, since this goal was given."""

    @property
    def stands(self) -> bool:
        """Whether the robot stands, because it has arrived, sees no way, or is lost."""
        return self.course in (Course.ARRIVED, Course.NO_WAY, Course.LOST)

    @property
    def text(self) -> str:
        """How it stands, in a few words; empty while there is no goal."""
        if self.goal is None:
            return ""
        match self.course:
            case Course.ARRIVED:
                return f"arrived: {self.goal.text}"
            case Course.NO_WAY:
                return f"no way from here to {self.goal.text}: nothing taught leads there"
            case Course.LOST:
                return f"lost on the way to {self.goal.text}: this place is not known; answer here, or set it down"
        left = 0 if self.plan is None else len(self.plan.ways)
        way = None if self.plan is None else self.plan.next
        if way is None:
            return f"on the way to {self.goal.text}: the plan begins behind the next junction"
        ways = "1 way" if left == 1 else f"{left} ways"
        return f"on the way to {self.goal.text}: {ways} left, now {way.action} (RLA {way.rla_id})"

    def seek(self, goal: Goal, target: Target) -> None:
        """Go there from now on; the plan is made at the next `arrive`."""
        self.goal, self._target = goal, target
        self._disappointed.clear()
        self.plan = None
        self.course = Course.UNDER_WAY
        self.surprises = 0

    def stop(self) -> None:
        """No goal any more."""
        self.goal = self._target = self.plan = None
        self.course = Course.NONE

    def arrive(self, situation: Vector) -> None:
        """The robot has come to a place: is it the goal, or where the plan leads to, and how does it go on?"""
        if self._target is None or self.course is Course.ARRIVED:
            return
        if self._target.met_by(situation):
            self.course, self.plan = Course.ARRIVED, None
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
        """What is known has changed, or where the robot is: plan from here."""
        self.plan = None
        self.arrive(situation)

    def choose(self, group: tuple[Rla, ...]) -> Rla | None:
        """Of the RLAs on the place where the robot is, the one that the plan goes by; None where it has no opinion."""
        way = None if self.plan is None else self.plan.next
        if way is None:
            return None
        return next((rla for rla in group if rla.rla_id == way.rla_id), None)

    def _plan_from(self, group: tuple[Rla, ...]) -> None:
        assert self._target is not None
        self.plan = None
        if not group:
            self.course = Course.LOST
            return
        here, chart = group[0].rla_id, self._chart()
        goals = chart.places_that_meet(self._target)
        if here in goals:
            self._disappointed.add(here)
        plan = plan_to(chart, here, goals - self._disappointed)
        self.course = Course.NO_WAY if plan is None else Course.UNDER_WAY
        if plan is not None:
            self._planned_on = chart
            self._follow(plan)

    def _follow(self, plan: Plan) -> None:
        self.plan = plan
        assert self._planned_on is not None
        assert plan.next is not None
        self._next_place = self._planned_on.members(plan.next.end)
