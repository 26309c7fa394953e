"""Drives of a certificate: many at once in a batch, or one on the CAN bus, with equal outcomes."""

import math
import random
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, replace
from itertools import pairwise

from behaviors.metrics.task_metric import BorderMetric, TaskMetric
from hal.batch import Batch, BatchFactory, FollowedSimulation, Start, Tally
from hal.robot_settings import RobotSettings
from hal.simulation import Position, SimulationFactory
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.certify.run import Run, RunOutcome
from kurt2rt.experiments.lockstep.batch_guide import BatchGuide
from kurt2rt.experiments.lockstep.batch_mind import (
    build_drive_settings,
    build_minds,
    guides_robots,
    require_known,
)
from kurt2rt.experiments.lockstep.episode import build_stuck_rule
from kurt2rt.experiments.lockstep.exam import ExamResult, ExamSetup, examine
from kurt2rt.experiments.lockstep.faulty_sensor import parse_break
from kurt2rt.experiments.study.pool import Progress

_STRETCH_TICKS = 500


@dataclass(frozen=True, slots=True)
class Subject:
    """Taught robot that is certified."""

    robot: RobotSettings
    task: TaskSettings
    events: Sequence[TeachingEvent]
    """Its lessons."""


def drive_in_batch(
    factory: BatchFactory, subject: Subject, runs: Sequence[Run], tell: Progress
) -> list[RunOutcome | None]:
    """Drive all runs at once and return their outcomes in order; None for a run that belongs on the CAN bus.

    `tell`: gets the simulated seconds of all runs so far.

    Raises:
        BatchRefusedError: the batch does not know the task or an action.
        SettingsError: task and world do not fit.
        UnknownActionError, UnknownBehaviourError: the knowledge does not fit the task.
    """
    with opened_batch(factory, subject, runs) as (batch, courses):
        period_s = subject.robot.cycle_s
        ticks = round(subject.task.exam.duration_s / period_s)
        if courses:
            _drive_guided(batch, courses, ticks, lambda done: tell(done * period_s))
        else:
            _drive_all(batch, len(runs), ticks, lambda done: tell(done * period_s))
        outcomes: list[RunOutcome | None] = []
        for r, run in enumerate(runs):
            outcomes.append(None if batch.reason_to_leave(r) else _outcome_of(run, batch.tally(r)))
        return outcomes


def _drive_all(batch: Batch, robots: int, ticks: int, tell: Progress) -> None:
    """Drive all robots for so many ticks; `tell`: gets the ticks of all so far."""
    active = list(range(robots))
    for begin in range(0, ticks, _STRETCH_TICKS):
        stretch = min(_STRETCH_TICKS, ticks - begin)
        if active:
            active = batch.drive(active, stretch)
        tell((begin + stretch) * robots)


def _drive_guided(batch: Batch, courses: Sequence["_Course"], ticks: int, tell: Progress) -> None:
    """Drive all robots for so many ticks, each guided by its course; `tell`: gets the ticks of all so far."""
    left = dict.fromkeys(range(len(courses)), ticks)
    while left:
        # A robot that stopped at a border is behind the others, and ends after them.
        stretch = min(_STRETCH_TICKS, max(left.values()))
        going = [r for r in left if left[r] >= stretch]
        batch.drive(going, stretch)
        for r in going:
            courses[r].follow(batch, r)
            tally = batch.tally(r)
            left[r] = 0 if batch.reason_to_leave(r) or tally.stuck else ticks - tally.ticks
        left = {r: ahead for r, ahead in left.items() if ahead}
        tell(ticks * len(courses) - sum(left.values()))


class _Course:
    """Course of one run that guides the robot at borders; else it measures nothing."""

    def __init__(self, simulation: FollowedSimulation, task: TaskSettings, setup: ExamSetup) -> None:
        """Build the metric at the robot's start. Raises SettingsError if task and world do not fit."""
        chance = random.Random(setup.chance_seed)
        metric = task.metric.build(simulation, task.behaviours, chance)
        assert isinstance(metric, BorderMetric)
        metric.reset(simulation.pose)
        if task.exam.start == "in_sight":
            simulation.reposition(chance, in_sight=True)
            metric.reset(simulation.pose)
        self._metric, self.guide = metric, BatchGuide(simulation, metric, chance)

    def follow(self, batch: Batch, robot: int) -> None:
        """Follow the newest stretch of a robot, and guide it."""
        if not batch.reason_to_leave(robot):
            self._metric.update_all(batch.stretch(robot).poses)
            self.guide.look_after(batch, robot)


def _outcome_of(run: Run, tally: Tally) -> RunOutcome:
    counts = tally._asdict()
    counts["end"] = tuple(counts.pop("pose"))
    return RunOutcome(number=run.number, world=run.world, **counts)


@contextmanager
def opened_batch(
    factory: BatchFactory, subject: Subject, runs: Sequence[Run]
) -> Iterator[tuple[Batch, Sequence[_Course]]]:
    """Yield a batch of the robots of all runs, at their starts, and their courses; none if they are not guided.

    Raises as `drive_in_batch`.
    """
    robot, task = subject.robot, subject.task
    setups = [ExamSetup(run.world, run.number) for run in runs]
    require_known(task, setups)
    with _opened(factory, setups) as simulations:
        courses: list[_Course] = []
        if guides_robots(task):
            courses = [_Course(each, task, setup) for each, setup in zip(simulations, setups, strict=True)]
        elif task.exam.start == "in_sight":
            _put_in_sight(task, simulations, setups)
        minds = build_minds(simulations, robot, task, [(subject.events, setup) for setup in setups])
        exam = task.exam
        rule = build_stuck_rule(exam.stuck_after_s, robot.cycle_s, least_m=exam.stuck_within_m)
        batch = factory.open_batch(simulations, minds, replace(build_drive_settings(robot, task), stuck=rule))
        for r, course in enumerate(courses):
            course.guide.begin(batch, r)
        yield batch, courses


def _put_in_sight(task: TaskSettings, simulations: Sequence[FollowedSimulation], setups: Sequence[ExamSetup]) -> None:
    for simulation, setup in zip(simulations, setups, strict=True):
        chance = random.Random(setup.chance_seed)
        task.metric.build(simulation, task.behaviours, chance)  # may draw before the robot is placed
        simulation.reposition(chance, in_sight=True)


@contextmanager
def _opened(factory: BatchFactory, setups: Sequence[ExamSetup]) -> Iterator[list[FollowedSimulation]]:
    """Yield an open simulation for each setup; close them all."""
    simulations = factory.open_all([Start(setup.world, setup.seed) for setup in setups], "exam")
    try:
        yield simulations
    finally:
        for simulation in simulations:
            simulation.close()


async def drive_on_bus(
    factory: SimulationFactory, subject: Subject, run: Run, tell: Progress
) -> tuple[RunOutcome, ExamResult]:
    """Drive a run on the CAN bus; return its outcome, and the exam's result with the trail.

    `tell`: gets the simulated seconds so far.

    Raises:
        SettingsError: task and world do not fit.
        LessonLostError: the robot refused a behaviour.
        UnknownActionError, UnknownBehaviourError: the knowledge does not fit the task.
    """
    with closing(factory.open(run.world, run.number, "exam")) as simulation:
        ticks = unknown_ticks = first_question = first_collision = 0
        stopped = ""

        def count(record: TickRecord, _metric: TaskMetric) -> None:
            nonlocal ticks, unknown_ticks, first_question, first_collision, stopped
            if simulation.collisions:
                first_collision = first_collision or record.tick
            if stopped:  # it stands until the exam ends
                return
            ticks = record.tick
            if record.decision.asking:
                unknown_ticks += 1
                first_question = first_question or ticks
            if stop := record.standing.stop:
                stopped = f"{stop.reason.value} {stop.name}".strip()

        broken = parse_break(run.broken, subject.robot.infrared) if run.broken else None
        setup = ExamSetup(run.world, run.number, broken=broken, on_tick=count)
        exam = await examine(simulation, subject.robot, subject.task, subject.events, setup, tell)
        outcome = RunOutcome(
            number=run.number,
            world=run.world,
            broken=run.broken,
            ticks=ticks,
            unknown_ticks=unknown_ticks,
            questions=len(exam.unknown_positions),
            first_question=first_question,
            collisions=exam.collisions,
            first_collision=first_collision,
            stuck=exam.stuck and not stopped,
            stopped=exam.alarm or stopped,
            travelled_m=_length_m(exam.trail),
            end=(*simulation.pose,),
        )
        return outcome, exam


def _length_m(trail: Sequence[Position]) -> float:
    """Return the length of a trail in m, rounded as the batch rounds it (simbridge.batch.record)."""
    length_m = 0.0
    for old, new in pairwise(trail):
        dx, dy = new.x_m - old.x_m, new.y_m - old.y_m
        length_m += math.sqrt(dx * dx + dy * dy)
    return length_m
