"""Sends a robot to goals, one after the other, without a teacher."""

import math
import random
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from behaviors.metrics.town import length_m
from hal.robot_settings import RobotSettings
from hal.simulation import Pose, Simulation
from kurt2rt.core.decision.goal import NamedGoal
from kurt2rt.core.decision.plan_step import GoalStatus
from kurt2rt.core.rla.rla import Rla, TeachingEvent
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.rla.usage_counter import StatisticsCounter
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.commands import BeAt, Command, Seek, StopSeeking
from kurt2rt.core.tick import TickRecord
from kurt2rt.experiments.lockstep.command_checks import require_carried_out
from kurt2rt.experiments.lockstep.exam import NoTeachingAllowed
from kurt2rt.experiments.lockstep.stuck_detector import StuckDetector
from kurt2rt.experiments.navigation.goals import GoalChosen
from kurt2rt.experiments.navigation.guided_tour import HOME
from kurt2rt.experiments.navigation.lesson import TRAIL_STRIDE, places_of, walk_in
from kurt2rt.experiments.navigation.outcome import ErrandDone, ErrandsRun, How
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runtime import build_runtime

_EXAMINER = "examiner"
_ASTRAY = 2.0
"""Who has no plan has gone astray after so many times the shortest way."""


class ByChance:
    """Any of the ways that are possible at a place (kurt2rt.core.mid.mid_level.TieBreaker)."""

    def __init__(self, chance: random.Random) -> None:
        self._chance = chance
        self._at: NDArray[np.float64] | None = None
        self._way: Rla | None = None

    def choose(self, group: tuple[Rla, ...], vector: NDArray[np.float64]) -> Rla | None:
        """One of them, the same until the next place."""
        if vector is not self._at or self._way not in group:
            self._at, self._way = vector, self._chance.choice(group)
        return self._way


async def run_errands(
    simulation: Simulation,
    settings: RobotSettings,
    task: TaskSettings,
    events: Sequence[TeachingEvent],
    saved: Statistics,
    goals: Sequence[GoalChosen],
    home: Pose,
    *,
    how: How,
    seed: int,
    on_progress: Callable[[float], None],
) -> ErrandsRun:
    """One goal after the other, each from where the one before is.

    A robot that does not come to a goal is set down there, and is told where it is. Without a plan a goal counts as
    reached where the robot comes through it.
    """
    period_s = settings.can.cycle_s
    walk = walk_in(simulation.plan, task)
    clock = LockstepClock(simulation.step)
    runtime = build_runtime(
        simulation.robot,
        settings,
        task,
        events,
        NoTeachingAllowed(),
        clock,
        statistics=StatisticsCounter(dict(saved.uses), dict(saved.transitions)),
        checkpoint=saved,
        teacher_available=False,
    )
    assert runtime.mid is not None
    if how == "chance":
        runtime.mid.chooser = ByChance(random.Random(f"ways of robot {seed}"))
    limit = round(task.exam.duration_s / period_s)
    done: list[ErrandDone] = []
    trail: list[tuple[float, float]] = []
    way = StuckDetector(task.exam.stuck_after_s, period_s, least_m=task.exam.stuck_within_m)
    said = 0
    number = ticks = 0
    way_m = 0.0
    start = before = home
    touched = simulation.collisions
    surprises = 0

    def say(make: Callable[[str], Command]) -> None:
        nonlocal said
        said += 1
        runtime.inbox.put(make(f"errands-{said}"))

    def begin() -> None:
        nonlocal start, before, way_m, ticks, touched, surprises
        start = before = simulation.pose
        way_m, ticks, touched, surprises = 0.0, 0, simulation.collisions, 0
        way.restart()
        if how == "planning":
            say(lambda command_id: Seek(command_id, _EXAMINER, NamedGoal(goals[number].name)))

    def put(pose: Pose, name: str) -> None:
        simulation.put(pose)
        runtime.reposition()
        walk.put(pose)
        say(lambda command_id: StopSeeking(command_id, _EXAMINER))
        say(lambda command_id: BeAt(command_id, _EXAMINER, name))

    def judge(record: TickRecord) -> str | None:
        """How the errand ended; empty: at its goal; None while it goes on."""
        goal, decision = goals[number], record.decision
        there = walk.street == goal.street
        plan = decision.plan
        if how == "planning":
            if plan is not None and ticks > 1 and plan.course is GoalStatus.ARRIVED:
                return "" if there else "it took another place for it"
            if plan is not None and ticks > 1 and plan.course in (GoalStatus.NO_WAY, GoalStatus.LOST):
                return plan.course.value
        elif there:
            return ""
        elif way_m > _ASTRAY * length_m(goal.shortest):
            return "astray"
        if record.guard_result.latched:
            return record.guard_result.reasons[0]
        if way.none_since_window(simulation.position):
            return "stuck: " + (decision.cause.value if not decision.driving else "driving")
        return "time" if ticks >= limit else None

    def after_tick(record: TickRecord) -> None:
        nonlocal number, ticks, way_m, before, surprises
        require_carried_out(record, task)
        pose = simulation.pose
        walk.follow(pose)
        ticks += 1
        way_m += math.hypot(pose.x_m - before.x_m, pose.y_m - before.y_m)
        before = pose
        if record.decision.plan is not None:
            surprises = record.decision.plan.surprises
        ended = judge(record)
        if record.tick % TRAIL_STRIDE == 0:
            trail.append(simulation.position)
        if ended is None:
            return
        goal = goals[number]
        shortest_m = length_m(goal.shortest, start, None if ended else pose)
        done.append(
            ErrandDone(
                goal=goal.name,
                why_not=ended,
                seconds=ticks * period_s,
                way_m=way_m,
                shortest_m=shortest_m,
                junctions=len(goal.shortest) - 1,
                demonstrated=None if math.isinf(goal.demonstrated) else goal.demonstrated,
                surprises=surprises,
                collisions=simulation.collisions - touched,
            )
        )
        on_progress(number + 1.0)
        number += 1
        if number == len(goals):
            runtime.scheduler.end()
            return
        if ended:
            if record.guard_result.latched:
                simulation.robot.release()
            put(goal.street.middle, goal.name)
        begin()

    put(home, HOME)
    if goals:
        begin()
        await runtime.scheduler.run(limit * len(goals) + 1, after_tick)
    return ErrandsRun(how=how, errands=tuple(done), trail=places_of(trail))
