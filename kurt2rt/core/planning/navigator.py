"""Between plan and mid level: says which of the ways from a place is gone while the robot seeks a goal."""

import re
from collections.abc import Callable, Mapping

import numpy as np

from kurt2rt.core.decision.goal import Goal, NamedGoal, RlaGoal
from kurt2rt.core.decision.plan_step import GoalStatus, PlanStep
from kurt2rt.core.mid.mid_level import MidLevel
from kurt2rt.core.mid.place import Place
from kurt2rt.core.outcome import CommandRefusedError, RefusalCode
from kurt2rt.core.outcome_text import text_of
from kurt2rt.core.planning.distances import distance_function
from kurt2rt.core.planning.goal_pursuit import GoalPursuit
from kurt2rt.core.planning.target import Target, Vector, make_target
from kurt2rt.core.planning.topological_map import Forecast, MapBuild, build_map
from kurt2rt.core.rla.condition import Condition
from kurt2rt.core.rla.rla import MID, Rla

_BEFORE_THE_NEXT_M = 0.3
"""Way behind a junction within which a plan may still say what is done at the next one: farther on the robot may be in
that one already, and must not change its mind in a turn."""
_ANEW_AFTER_TICKS = 25
"""However often what is known changes, a plan is begun anew for it no sooner."""
_PLACE_OF = re.compile(r"RLA ([1-9][0-9]{0,8})")


class Navigator:
    """The chooser of the mid level while there is a goal (kurt2rt.core.mid.mid_level.TieBreaker)."""

    def __init__(
        self,
        mid: MidLevel,
        follow_ups: Callable[[int], Mapping[int, int]],
        forecast: Callable[[int], Forecast | None],
    ) -> None:
        """`follow_ups`: how often each RLA followed one. `forecast`: what is expected of one.

        Both are looked at when a plan is made. Where the situation of the mid level is a place, it is put right at
        places that are known from now on; where some are known already, the robot was switched on at none of them that
        it could tell, and is lost until somebody says where it is.
        """
        self._mid = mid
        self._system = mid.system
        self._space = mid.settings.space
        self._distance = distance_function(self._space)
        self._follow_ups = follow_ups
        self._forecast = forecast
        self._pursuit = GoalPursuit(self._build_map, self._group_at)
        self._refreshed_at: Vector | None = None
        """The situation that the plan was last looked at in."""
        self._changes = self._system.changes
        self._rlas = self._system.rlas_at(MID)
        self._goal_condition: Condition | None = None
        """The situation that the goal meant when it was last looked at; None where it means more than one."""
        self._outdated = False
        """Whether the plan is to be begun anew, for what is known has changed."""
        self._ticks = 0
        self._planned_at_tick = -_ANEW_AFTER_TICKS
        self._chosen: int | None = None
        self._chosen_at: Vector | None = None
        """What was chosen last, and in which situation."""
        mid.tie_breaker = self
        if isinstance(mid.situation, Place):
            mid.situation.known_place = self._known_place
            if self._rlas or self.named_situations:
                mid.restart()
        self.status: PlanStep | None = None
        """How it stands with the goal; None while there is none."""

    @property
    def goal_status(self) -> GoalStatus:
        """How it stands with the goal."""
        return self._pursuit.status

    @property
    def stands_as(self) -> GoalStatus | None:
        """Why the robot is to stand: at its goal, or without a way there; None where it is not."""
        return self._pursuit.stands_as

    @property
    def named_situations(self) -> Mapping[str, Condition]:
        """What can be gone to by name."""
        return self._system.named_situations(MID)

    def seek(self, goal: Goal) -> str:
        """Go there from now on; how it stands. Raises CommandRefusedError."""
        target = self._target_of(goal)
        self._changes, self._rlas = self._system.changes, self._system.rlas_at(MID)
        self._begin(goal, target)
        assert self.status is not None
        return self.status.says

    def stop(self) -> None:
        """Seek nothing any more: from the next junction on the mid level commands as ever."""
        self._pursuit.stop()
        self._publish()

    def localise(self, name: str) -> None:
        """The robot is at a place that has a name, or at that of an RLA, such as RLA 12.

        Raises CommandRefusedError where it is none, or places are not known.
        """
        situation = self._mid.situation
        if not isinstance(situation, Place):
            raise CommandRefusedError(RefusalCode.NO_PLACES)
        situation.localise(self._named_condition(name))
        self._pursuit.plan = None

    def choose(self, group: tuple[Rla, ...], vector: Vector) -> Rla | None:
        """The way that the plan says, of those from here; one that was begun is gone to its end."""
        self.refresh()
        chosen = self._pursuit.choose(group)
        if chosen is None and vector is self._chosen_at:
            chosen = next((rla for rla in group if rla.rla_id == self._chosen), None)
        if chosen is not None:
            self._chosen, self._chosen_at = chosen.rla_id, vector
        return chosen

    def step(self) -> None:
        """Once in each tick: look, and work on the plan as long as a tick has time for that."""
        self._ticks += 1
        self.refresh()
        if self._outdated:
            if self._ticks - self._planned_at_tick >= _ANEW_AFTER_TICKS:
                self._planned_at_tick, self._outdated = self._ticks, False
                self._pursuit.replan(self._mid.vector)
                self._publish()
            return
        stands = self._pursuit.stands
        if self._pursuit.plan_step():
            if not stands and self._is_too_late():
                self._pursuit.defer_plan()
            self._publish()

    def refresh(self) -> None:
        """Notice a new situation, or that the plan cannot be followed any more; begin a plan where that is needed."""
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
        seeking, before = self._pursuit, self._rlas
        self._rlas = self._system.rlas_at(MID)
        if seeking.goal is None or seeking.status is GoalStatus.ARRIVED:
            return
        try:
            target = self._target_of(seeking.goal)
        except CommandRefusedError as error:
            self._goal_condition, self._outdated = None, False
            seeking.give_up(text_of(error.outcome))
            return
        if self._condition_of(seeking.goal) != self._goal_condition:
            self._begin(seeking.goal, target)
        elif self._rlas != before:
            seeking.retarget(target)
            planning = seeking.status is GoalStatus.PLANNING
            self._outdated = self._outdated or planning or seeking.stands or not self._is_plan_valid()

    def _begin(self, goal: Goal, target: Target) -> None:
        at_once = self._pursuit.stands or self._is_near_junction()
        self._goal_condition, self._outdated = self._condition_of(goal), False
        self._pursuit.seek(goal, target)
        # Else the next junction is left as it was to be, and the plan begins behind it.
        self._refreshed_at = None if at_once else self._mid.vector
        self.refresh()
        self._publish()

    def _target_of(self, goal: Goal) -> Target:
        return make_target(
            goal,
            named=self.named_situations,
            rla=self._system.get,
            level=MID,
            features=self._mid.situation.features,
            radius=self._space.radius,
            distance=self._distance,
            group_at=self._group_at,
        )

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
        """Whether the way that is being gone still is what it was when it was planned."""
        plan = self._pursuit.plan
        if plan is None or plan.next is None:
            return True
        rla = self._system.get(plan.next.rla_id)
        return rla is not None and rla.action == plan.next.action

    def _is_too_late(self) -> bool:
        """Whether the robot may be in the next junction already, on another way than the one that was planned."""
        plan, situation = self._pursuit.plan, self._mid.situation
        if plan is None or plan.next is None or not isinstance(situation, Place):
            return False
        return situation.since_m > _BEFORE_THE_NEXT_M and plan.next.action != self._mid.commanded

    def _is_near_junction(self) -> bool:
        situation = self._mid.situation
        return isinstance(situation, Place) and situation.since_m <= _BEFORE_THE_NEXT_M

    def _group_at(self, situation: Vector) -> tuple[Rla, ...]:
        match = self._system.match(situation, level=MID)
        return self._system.competitors(match.rla) if match is not None and match.distance <= match.radius else ()

    def _known_place(self, situation: Vector) -> Condition | None:
        group = self._group_at(situation)
        if group:
            return group[0].condition
        near = [place for place in self.named_situations.values() if self._is_near(situation, place)]
        return min(near, key=lambda place: self._distance(situation, np.array(place))) if near else None

    def _is_near(self, situation: Vector, place: Condition) -> bool:
        return self._distance(situation, np.array(place)) <= self._space.radius

    def _build_map(self) -> MapBuild:
        return build_map(self._rlas, self._group_at, self._follow_ups, self._forecast)

    def _publish(self) -> None:
        seeking = self._pursuit
        if seeking.goal is None:
            self.status = None
            return
        ways = () if seeking.plan is None else seeking.plan.edges
        self.status = PlanStep(
            seeking.goal.text,
            seeking.status,
            tuple(way.action for way in ways),
            ways[0].rla_id if ways else None,
            seeking.text,
            seeking.surprises,
        )
