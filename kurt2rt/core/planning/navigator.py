"""Navigator: chooses among the mid-level RLAs of a place by the plan to a goal."""

import re
from collections.abc import Callable, Mapping

import numpy as np

from kurt2rt.core.decision.decision import GoalStatus, PlanStep
from kurt2rt.core.decision.goal import Goal, NamedGoal, RlaGoal
from kurt2rt.core.mid.mid_level import MidLevel
from kurt2rt.core.mid.place import PlaceSituation
from kurt2rt.core.outcome import CommandRefusedError, RefusalCode
from kurt2rt.core.outcome_text import text_of
from kurt2rt.core.planning.goal_pursuit import GoalPursuit
from kurt2rt.core.planning.target import Target, Vector, distance_function, make_target
from kurt2rt.core.planning.topological_map import MapBuild, build_map
from kurt2rt.core.rla.condition import Condition
from kurt2rt.core.rla.rla import MID, Rla
from kurt2rt.core.rla.statistics import Expectation

_CHOICE_DISTANCE_M = 0.3
"""Distance after a junction up to which a plan may choose for the next one; beyond it the robot may turn there."""
_REPLAN_AFTER_TICKS = 25
"""Least number of ticks between two plans because of changed knowledge."""
_PLACE_OF = re.compile(r"RLA ([1-9][0-9]{0,8})")


class Navigator:
    """Planner of the way to a goal: chooses, among RLAs of one condition, the one that leads there.

    The mid level asks it as its tie breaker (kurt2rt.core.mid.mid_level.TieBreaker).
    """

    def __init__(
        self,
        mid: MidLevel,
        follow_ups: Callable[[int], Mapping[int, int]],
        forecast: Callable[[int], Expectation | None],
    ) -> None:
        """Connect to a mid level. If its situation is a place, known places correct the dead reckoning.

        If places are known at the start, the robot is lost until a teacher localises it.

        Args:
            mid: mid level whose tie breaker this becomes.
            follow_ups: RLA id -> {follow-up id: count}; read for each plan.
            forecast: expectation of an RLA; None before its first end.
        """
        self._mid = mid
        self._system = mid.system
        self._space = mid.settings.space
        self._distance = distance_function(self._space)
        self._follow_ups = follow_ups
        self._forecast = forecast
        self._pursuit = GoalPursuit(self._build_map, self._group_at)
        self._refreshed_at: Vector | None = None
        """Situation of the last refresh."""
        self._changes = self._system.changes
        self._rlas = self._system.rlas_at(MID)
        self._goal_condition: Condition | None = None
        """Condition of the goal at the last refresh; None for a goal with several situations."""
        self._outdated = False
        """Return whether changed knowledge requires a new plan."""
        self._ticks = 0
        self._planned_at_tick = -_REPLAN_AFTER_TICKS
        self._chosen: int | None = None
        self._chosen_at: Vector | None = None
        """Situation of the last choice."""
        mid.tie_breaker = self
        if isinstance(mid.situation, PlaceSituation):
            mid.situation.known_place = self._known_place
            if self._rlas or self.named_situations:
                mid.restart()
        self.status: PlanStep | None = None
        """Goal and plan as reported with each tick; None without a goal."""

    @property
    def standing_status(self) -> GoalStatus | None:
        """Reason to stand, ARRIVED or NO_WAY; None to drive."""
        return self._pursuit.standing_status

    @property
    def named_situations(self) -> Mapping[str, Condition]:
        """Named situations of the mid level."""
        return self._system.named_situations(MID)

    def seek(self, goal: Goal) -> GoalStatus:
        """Set the goal and return its status. Raises CommandRefusedError for an unknown goal."""
        target = self._target_of(goal)
        self._changes, self._rlas = self._system.changes, self._system.rlas_at(MID)
        self._begin(goal, target)
        return self._pursuit.status

    def stop(self) -> None:
        """Drop the goal; the nearest mid-level RLA commands again from the next junction on."""
        self._pursuit.stop()
        self._publish()

    def localise(self, name: str) -> None:
        """Set the position to a named place, or to that of an RLA, such as RLA 12.

        Raises CommandRefusedError for an unknown place, or if the mid level knows no places.
        """
        situation = self._mid.situation
        if not isinstance(situation, PlaceSituation):
            raise CommandRefusedError(RefusalCode.NO_PLACES)
        situation.localise(self._named_condition(name))
        self._pursuit.plan = ()

    def choose(self, group: tuple[Rla, ...], vector: Vector) -> Rla | None:
        """Return the RLA of the group that the plan uses at a mid-level situation `vector` (d,); None if none.

        The last choice stays valid as long as `vector` is the same object.
        """
        self.refresh()
        chosen = self._pursuit.choose(group)
        if chosen is None and vector is self._chosen_at:
            chosen = next((rla for rla in group if rla.rla_id == self._chosen), None)
        if chosen is not None:
            self._chosen, self._chosen_at = chosen.rla_id, vector
        return chosen

    def step(self) -> None:
        """Process a new situation or changed knowledge, and do one tick of planning; call it in each tick."""
        self._ticks += 1
        self.refresh()
        if self._outdated:
            if self._ticks - self._planned_at_tick >= _REPLAN_AFTER_TICKS:
                self._planned_at_tick, self._outdated = self._ticks, False
                self._pursuit.replan(self._mid.vector)
                self._publish()
            return
        stands = self._pursuit.stands
        if self._pursuit.plan_step():
            if not stands and self._is_too_late():
                self._pursuit.plan = ()  # the next arrival plans again
            self._publish()

    def refresh(self) -> None:
        """Process a new situation or changed knowledge; begin a plan if necessary. Does nothing without a goal."""
        if self._pursuit.goal is None:
            return
        vector, changes = self._mid.vector, self._system.changes
        if vector is self._refreshed_at and changes == self._changes:
            return
        if changes != self._changes:
            self._changes = changes
            self._on_knowledge_changed()
        if vector is not self._refreshed_at:
            self._refreshed_at, self._outdated = vector, False
            self._pursuit.arrive(vector)
        self._publish()

    def _on_knowledge_changed(self) -> None:
        pursuit, before = self._pursuit, self._rlas
        self._rlas = self._system.rlas_at(MID)
        if pursuit.goal is None or pursuit.status is GoalStatus.ARRIVED:
            return
        try:
            target = self._target_of(pursuit.goal)
        except CommandRefusedError as error:
            self._goal_condition, self._outdated = None, False
            pursuit.give_up(text_of(error.outcome))
            return
        if self._condition_of(pursuit.goal) != self._goal_condition:
            self._begin(pursuit.goal, target)
        elif self._rlas != before:
            pursuit.retarget(target)
            planning = pursuit.status is GoalStatus.PLANNING
            self._outdated = self._outdated or planning or pursuit.stands or not self._is_plan_valid()

    def _begin(self, goal: Goal, target: Target) -> None:
        at_once = self._pursuit.stands or self._is_near_junction()
        self._goal_condition, self._outdated = self._condition_of(goal), False
        self._pursuit.seek(goal, target)
        # Otherwise the next junction is driven as commanded, and the plan begins after it.
        self._refreshed_at = None if at_once else self._mid.vector
        self.refresh()
        self._publish()

    def _target_of(self, goal: Goal) -> Target:
        features = self._mid.situation.features
        return make_target(goal, self._system, features, self._space, self._distance, self._group_at)

    def _condition_of(self, goal: Goal) -> Condition | None:
        match goal:
            case NamedGoal(name):
                return self.named_situations.get(name)
            case RlaGoal(rla_id):
                rla = self._system.get(rla_id)
                return None if rla is None else rla.condition
        return None

    def _named_condition(self, name: str) -> Condition:
        if name in self.named_situations:
            return self.named_situations[name]
        number = _PLACE_OF.fullmatch(name)
        rla = None if number is None else self._system.get(int(number[1]))
        if rla is not None and rla.level == MID:
            return rla.condition
        raise CommandRefusedError(RefusalCode.NO_PLACE, name=name, known=tuple(sorted(self.named_situations)))

    def _is_plan_valid(self) -> bool:
        """Return whether the present edge of the plan still exists with its action."""
        plan = self._pursuit.plan
        if not plan:
            return True
        rla = self._system.get(plan[0].rla_id)
        return rla is not None and rla.action == plan[0].action

    def _is_too_late(self) -> bool:
        """Return whether the robot may already be in the next junction with another action than planned."""
        plan, situation = self._pursuit.plan, self._mid.situation
        if not plan or not isinstance(situation, PlaceSituation):
            return False
        return situation.since_m > _CHOICE_DISTANCE_M and plan[0].action != self._mid.commanded

    def _is_near_junction(self) -> bool:
        situation = self._mid.situation
        return isinstance(situation, PlaceSituation) and situation.since_m <= _CHOICE_DISTANCE_M

    def _group_at(self, situation: Vector) -> tuple[Rla, ...]:
        match = self._system.match(situation, level=MID)
        return self._system.competitors(match.rla) if match is not None and match.distance <= match.radius else ()

    def _known_place(self, situation: Vector) -> Condition | None:
        group = self._group_at(situation)
        if group:
            return group[0].condition

        def away(place: Condition) -> float:
            return self._distance(situation, np.array(place))

        nearest = min(self.named_situations.values(), key=away, default=None)
        return nearest if nearest is not None and away(nearest) <= self._space.radius else None

    def _build_map(self) -> MapBuild:
        return build_map(self._rlas, self._group_at, self._follow_ups, self._forecast)

    def _publish(self) -> None:
        pursuit = self._pursuit
        if pursuit.goal is None:
            self.status = None
            return
        edges = pursuit.plan
        self.status = PlanStep(
            pursuit.goal.text,
            pursuit.status,
            tuple(edge.action for edge in edges),
            edges[0].rla_id if edges else None,
            pursuit.text,
            pursuit.surprises,
        )
