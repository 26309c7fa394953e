"""Between plan and mid level: says which of the ways from a place is gone while the robot seeks a goal."""

from collections.abc import Callable, Mapping

import numpy as np

from kurt2rt.layers.mid_level import MidLevel
from kurt2rt.mid.place import Place
from kurt2rt.planning.chart import Chart, Forecast, chart_of
from kurt2rt.planning.distances import distance_in
from kurt2rt.planning.goal import Goal
from kurt2rt.planning.seeking import Seeking
from kurt2rt.planning.step import Course, PlanStep
from kurt2rt.planning.target import Vector, target_of
from kurt2rt.rla.rla import MID, Condition, Rla

_BEFORE_THE_NEXT_M = 0.3
"""Way behind a junction within which a plan may still say what is done at the next one: farther on the robot may be in
that one already, and must not change its mind in a turn."""


class Navigator:
    """The chooser of the mid level while there is a goal (kurt2rt.layers.mid_level.Chooser)."""

    def __init__(
        self,
        mid: MidLevel,
        follow_ups: Callable[[int], Mapping[int, int]],
        forecast: Callable[[int], Forecast | None],
    ) -> None:
        """`follow_ups`: how often each RLA followed one. `forecast`: what is expected of one.

        Both are looked at when a plan is made. Where the situation of the mid level is a place, it is put right at
        places that are known from now on.
        """
        self._mid = mid
        self._system = mid.system
        self._space = mid.settings.space
        self._distance = distance_in(self._space)
        self._follow_ups = follow_ups
        self._forecast = forecast
        self._seeking = Seeking(self._chart, self._group_at)
        self._seen: Vector | None = None
        """The situation that the plan was last looked at in."""
        self._changes = self._system.changes
        self._chosen: int | None = None
        self._chosen_at: Vector | None = None
        """What was chosen last, and in which situation."""
        mid.chooser = self
        if isinstance(mid.situation, Place):
            mid.situation.known = self._known_place
        self.step: PlanStep | None = None
        """How it stands with the goal; None while there is none."""

    @property
    def course(self) -> Course:
        """How it stands with the goal."""
        return self._seeking.course

    @property
    def named(self) -> Mapping[str, Condition]:
        """What can be gone to by name."""
        return self._system.named_at(MID)

    def seek(self, goal: Goal) -> str:
        """Go there from now on; how it stands. Raises NoSuchGoalError."""
        target = target_of(
            goal,
            named=self.named,
            rla=self._system.get,
            level=MID,
            features=self._mid.situation.features,
            radius=self._space.radius,
            distance=self._distance,
            group_at=self._group_at,
        )
        at_once = self._seeking.stands or self._has_just_come()
        self._seeking.seek(goal, target)
        # Else the next junction is left as it was to be, and the plan begins behind it.
        self._seen = None if at_once else self._mid.vector
        self.look()
        self._tell()
        assert self.step is not None
        return self.step.says

    def stop(self) -> None:
        """Seek nothing any more: from the next junction on the mid level commands as ever."""
        self._seeking.stop()
        self._tell()

    def be_at(self, name: str) -> None:
        """The robot is at a place that has a name. Raises ValueError where it is none, or places are not known."""
        situation = self._mid.situation
        if not isinstance(situation, Place):
            raise ValueError("this robot's mid level does not know places")  # noqa: TRY004 - of words, not of types
        if name not in self.named:
            raise ValueError(f"nothing was named {name!r}; named were: {', '.join(sorted(self.named)) or 'nothing'}")
        situation.be_at(self.named[name])
        self._seeking.plan = None

    def choose(self, group: tuple[Rla, ...], vector: Vector) -> Rla | None:
        """The way that the plan says, of those from here; one that was begun is gone to its end."""
        self.look()
        chosen = self._seeking.choose(group)
        if chosen is None and vector is self._chosen_at:
            chosen = next((rla for rla in group if rla.rla_id == self._chosen), None)
        if chosen is not None:
            self._chosen, self._chosen_at = chosen.rla_id, vector
        return chosen

    def look(self) -> None:
        """Notice a new situation, or that the plan cannot be followed any more; plan where that is needed."""
        if self._seeking.goal is None:
            return
        vector, changes = self._mid.vector, self._system.changes
        if vector is self._seen and changes == self._changes:
            return
        if vector is not self._seen:
            self._seeking.arrive(vector)
        elif self._seeking.stands or not self._still_possible():
            self._seeking.replan(vector)
        self._seen, self._changes = vector, changes
        self._tell()

    def _still_possible(self) -> bool:
        """Whether the way that is being gone still is what it was when it was planned."""
        plan = self._seeking.plan
        if plan is None or plan.next is None:
            return True
        rla = self._system.get(plan.next.rla_id)
        return rla is not None and rla.action == plan.next.action

    def _has_just_come(self) -> bool:
        situation = self._mid.situation
        return isinstance(situation, Place) and situation.since_m <= _BEFORE_THE_NEXT_M

    def _group_at(self, situation: Vector) -> tuple[Rla, ...]:
        match = self._system.match(situation, level=MID)
        return self._system.competitors(match.rla) if match is not None and match.distance <= match.radius else ()

    def _known_place(self, situation: Vector) -> Condition | None:
        group = self._group_at(situation)
        if group:
            return group[0].condition
        near = [place for place in self.named.values() if self._is_near(situation, place)]
        return min(near, key=lambda place: self._distance(situation, np.array(place))) if near else None

    def _is_near(self, situation: Vector, place: Condition) -> bool:
        return self._distance(situation, np.array(place)) <= self._space.radius

    def _chart(self) -> Chart:
        return chart_of(self._system.rlas_at(MID), self._group_at, self._follow_ups, self._forecast)

    def _tell(self) -> None:
        seeking = self._seeking
        if seeking.goal is None:
            self.step = None
            return
        ways = () if seeking.plan is None else seeking.plan.ways
        self.step = PlanStep(
            seeking.goal.text,
            seeking.course,
            tuple(way.action for way in ways),
            ways[0].rla_id if ways else None,
            seeking.text,
            seeking.surprises,
        )
