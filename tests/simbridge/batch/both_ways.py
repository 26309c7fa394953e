"""One drive on the CAN bus and in a batch, compared tick by tick."""

import math
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass, replace

import anyio

from behaviors.metrics.task_metric import TaskMetric
from hal.kurt2_settings import load_kurt2
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.batch_mind import build_drive_settings, build_minds
from kurt2rt.experiments.lockstep.exam import ExamSetup, examine
from simbridge.contracts.simulation import Pose
from simbridge.simulation import Kurt2SimulationFactory

ROBOT = load_kurt2()
FACTORY = Kurt2SimulationFactory(ROBOT)


@dataclass(frozen=True)
class Step:
    """Decision and pose of one tick."""

    pose: Pose
    action: str | None
    rla_id: int | None
    distance: float


@dataclass(frozen=True)
class Drive:
    steps: list[Step]
    state_hash: str
    left: str = ""
    """Reason that the robot left the batch."""
    collisions: int = 0


def drive_on_bus(task: TaskSettings, setup: ExamSetup) -> Drive:
    """Return an exam's drive on the CAN bus."""
    steps: list[Step] = []
    with closing(FACTORY.open(setup.world, setup.seed, "exam")) as simulation:

        def look(record: TickRecord, _metric: TaskMetric) -> None:
            decision = record.decision
            distance = math.inf if decision.match is None else decision.match.distance
            steps.append(Step(simulation.pose, decision.action, decision.rla_id, distance))

        anyio.run(examine, simulation, ROBOT, task, replace(setup, on_tick=look), lambda _: None)
        return Drive(steps, simulation.simulated_robot.state_hash())


def drive_in_batch(task: TaskSettings, exams: Sequence[ExamSetup], stretch: int = 70) -> list[Drive]:
    """Return the drives of exams, all in one batch."""
    simulations = [FACTORY.open(setup.world, setup.seed, "exam") for setup in exams]
    for simulation in simulations:
        simulation.close()
    minds = build_minds(simulations, ROBOT, task, exams)
    batch = FACTORY.open_batch(simulations, minds, build_drive_settings(ROBOT, task))
    ids = [getattr(mind, "rla_ids", ()) for mind in minds]
    steps: list[list[Step]] = [[] for _ in exams]
    collisions = [0] * len(exams)
    ticks = round(task.exam.duration_s / ROBOT.cycle_s)
    for begin in range(0, ticks, stretch):
        active = [r for r in range(len(exams)) if not batch.reason_to_leave(r)]
        batch.drive(active, min(stretch, ticks - begin))
        for r in active:
            if batch.reason_to_leave(r):
                continue
            course = batch.stretch(r)
            simulations[r].follow(course.poses)
            collisions[r] = course.collisions[-1]
            for pose, action, rla, distance, *_ in zip(*course, strict=True):
                name, rla_id = batch.actions[action] if action >= 0 else None, ids[r][rla] if rla >= 0 else None
                steps[r].append(Step(pose, name, rla_id, distance))
    return [
        Drive(steps[r], batch.state_hash(r, simulations[r].laps), batch.reason_to_leave(r), collisions[r])
        for r in range(len(exams))
    ]


def first_difference(bus: Drive, batch: Drive) -> str:
    """Return the first tick and field that differ; empty for equal drives."""
    for tick, (one, other) in enumerate(zip(bus.steps, batch.steps, strict=False), start=1):
        for field in Step.__dataclass_fields__:
            if getattr(one, field) != getattr(other, field):
                return f"tick {tick}: {field} {getattr(one, field)} on the bus, {getattr(other, field)} in the batch"
    if len(bus.steps) != len(batch.steps):
        return f"{len(bus.steps)} ticks on the bus, {len(batch.steps)} in the batch {batch.left}"
    return "" if bus.state_hash == batch.state_hash else "the state hash"
