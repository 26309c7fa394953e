"""Navigation exam: a robot drives to goals, named places to which no tour led directly, without a teacher."""

import math
import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from behaviors.metrics.errands import Errands, ErrandsSettings
from behaviors.metrics.town import Street, Town, length_m
from config.settings import Settings
from kurt2rt.core.decision.decision import GoalStatus
from kurt2rt.core.decision.goal import NamedGoal
from kurt2rt.core.teaching.commands import BeAt, Seek, StopSeeking
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.command_checks import require_carried_out
from kurt2rt.experiments.lockstep.episode import Episode
from kurt2rt.experiments.navigation.guided_tour import HOME
from kurt2rt.runtime import Runtime
from simbridge.contracts.simulation import Pose, Simulation

_EXAMINER = "examiner"


@dataclass(frozen=True, slots=True)
class GoalChosen:
    """Goal of a navigation exam: a named place, the street to start from, and the shortest way."""

    name: str
    start: Street
    street: Street
    """Street of the name."""
    shortest: tuple[Street, ...]
    """The shortest way there, both ends among them."""
    demonstrated_m: float
    """The shortest way that the robot was led from there to there in one piece; infinite where it never was."""

    @property
    def demonstrated(self) -> float:
        """Ratio of `demonstrated_m` and the shortest distance in m."""
        return self.demonstrated_m / length_m(self.shortest)


def choose_goals(
    town: Town,
    named: Mapping[str, Street],
    led: Sequence[Street | None],
    start: Street,
    settings: ErrandsSettings,
    chance: random.Random,
) -> tuple[GoalChosen, ...]:
    """Return successive goals, the first from `start`; fewer than required if there are none.

    `named`: street of each named place. `led`: streets of the tour; None before each repositioning.
    """
    chosen: list[GoalChosen] = []
    here = start
    while len(chosen) < settings.goals:
        possible = [
            goal
            for name, street in named.items()
            if street != here and (goal := _goal(town, name, here, street, led)) is not None
            if len(goal.shortest) > settings.junctions_at_least and goal.demonstrated > settings.detour_at_most
        ]
        if not possible:
            break
        goal = chance.choice(possible)
        chosen.append(goal)
        here = goal.street
    return tuple(chosen)


def _goal(town: Town, name: str, start: Street, street: Street, led: Sequence[Street | None]) -> GoalChosen | None:
    shortest = town.shortest(start, street)
    if shortest is None:
        return None
    return GoalChosen(name, start, street, shortest, demonstrated_m(led, start, street))


def demonstrated_m(led: Sequence[Street | None], start: Street, goal: Street) -> float:
    """Return the length in m of the shortest piece of the tour from one street to the other; infinite without one."""
    best_m, piece = math.inf, list[Street]()
    for street in led:
        if street is None:
            piece = []
        elif street == start:
            piece = [street]
        elif piece:
            piece.append(street)
        if street == goal and piece:
            best_m = min(best_m, length_m(piece))
            piece = []
    return best_m


class GoalOutcome(Settings):
    """Outcome of one drive to a goal, as the study stores it: way, shortest way, collisions."""

    goal: str
    why_not: str
    """Empty where it came there."""
    seconds: float
    way_m: float
    shortest_m: float
    """Shortest distance from start to end; of a missed goal, to the middle of its street."""
    junctions: int
    """Number of junctions on the shortest way."""
    demonstrated: float | None
    """The shortest way that it was led there in one piece, as a multiple of the shortest one; None: never."""
    surprises: int
    """Number of places that differed from the plan."""
    collisions: int

    @property
    def reached(self) -> bool:
        """True if the robot reached the goal without a collision."""
        return not self.why_not and not self.collisions

    @property
    def detour(self) -> float:
        """Ratio of the travelled and the shortest distance, both in m."""
        return self.way_m / max(self.shortest_m, 0.1)


class GoalsRun(Episode):
    """Episode in which the robot drives to goals, each from the end of the drive before.

    A robot that misses a goal is placed there and localised.
    """

    def __init__(
        self,
        simulation: Simulation,
        runtime: Runtime,
        goals: Sequence[GoalChosen],
        *,
        seed: int,
        on_goal: Callable[[float], None],
    ) -> None:
        """`runtime`: one with a mid level. `on_goal`: called with the number of goals that are done."""
        task = runtime.task
        super().__init__(
            simulation,
            runtime,
            random.Random(f"errands of robot {seed}"),
            stuck_after_s=task.exam.stuck_after_s,
            on_progress=on_goal,
        )
        assert runtime.mid is not None
        assert isinstance(self.metric, Errands)
        self._tracker = self.metric
        self._goals = goals
        self._limit_ticks = round(task.exam.duration_s / self.period_s)
        self._done: list[GoalOutcome] = []
        self._start = self._pose
        self._begun_tick = self._begun_collisions = self._surprises = 0
        self._failure: str | None = None

    async def drive(self, home: Pose) -> tuple[GoalOutcome, ...]:
        """Drive to all goals, from `home`, and return the outcome of each.

        Raises LessonLostError if the robot refused a command.
        """
        self._place_at(home, HOME)
        if self._goals:
            self._begin_goal()
            await self.run(self._limit_ticks * len(self._goals) + 1)
        return tuple(self._done)

    def on_tick(self, record: TickRecord) -> None:
        """Measure the drive and judge whether it is over. Raises LessonLostError if the robot refused a command."""
        require_carried_out(record, self.task)
        self.measure()
        if record.decision.plan is not None:
            self._surprises = record.decision.plan.surprises
        self._failure = self._judge(record)

    def on_second(self, record: TickRecord) -> None:
        """Report nothing: progress is counted in goals."""

    def after_tick(self, record: TickRecord) -> None:
        """Begin the next goal if the one before is reached or missed."""
        super().after_tick(record)
        if self._failure is None:
            return
        self._done.append(self._result(self._failure))
        self._on_progress(float(len(self._done)))
        if len(self._done) == len(self._goals):
            self.runtime.scheduler.end()
            return
        if self._failure:
            goal = self._goals[len(self._done) - 1]
            if record.guard_result.latched:
                self.simulation.robot.release()
            self._place_at(goal.street.middle, goal.name)
        self._begin_goal()

    def _judge(self, record: TickRecord) -> str | None:
        """Return why the goal was missed; empty: it is reached; None: the robot is on its way."""
        goal, decision = self._goals[len(self._done)], record.decision
        ticks = self.ticks - self._begun_tick
        there = self._tracker.street == goal.street
        plan = decision.plan
        if plan is not None and ticks > 1 and plan.course is GoalStatus.ARRIVED:
            return "" if there else "it took another place for it"
        if plan is not None and ticks > 1 and plan.course in (GoalStatus.NO_WAY, GoalStatus.LOST):
            return plan.course.value
        if record.guard_result.latched:
            return record.guard_result.reasons[0]
        if self.is_stuck():
            return "stuck: " + (decision.cause.value if not decision.driving else "driving")
        return "time" if ticks >= self._limit_ticks else None

    def _result(self, failure: str) -> GoalOutcome:
        goal = self._goals[len(self._done)]
        return GoalOutcome(
            goal=goal.name,
            why_not=failure,
            seconds=(self.ticks - self._begun_tick) * self.period_s,
            way_m=self.distance_travelled_m,
            shortest_m=length_m(goal.shortest, self._start, None if failure else self.simulation.pose),
            junctions=len(goal.shortest) - 1,
            demonstrated=None if math.isinf(goal.demonstrated) else goal.demonstrated,
            surprises=self._surprises,
            collisions=self.simulation.collisions - self._begun_collisions,
        )

    def _begin_goal(self) -> None:
        self.restart_counting()
        self._start = self._pose
        self._begun_tick, self._begun_collisions, self._surprises = self.ticks, self.simulation.collisions, 0
        self.send(Seek(self.next_id("errands"), _EXAMINER, NamedGoal(self._goals[len(self._done)].name)))

    def _place_at(self, pose: Pose, name: str) -> None:
        self.place(pose)
        self.send(StopSeeking(self.next_id("errands"), _EXAMINER))
        self.send(BeAt(self.next_id("errands"), _EXAMINER, name))
