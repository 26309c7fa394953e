"""Drive without a teacher in which surprises are counted."""

import random
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass
from typing import Literal

from hal.robot import Robot, SensorReadings
from hal.robot_proxy import RobotProxy
from hal.robot_settings import RobotSettings
from hal.simulation import Simulation, SimulationFactory
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.commands import Pursue, Resume
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.episode import Episode
from kurt2rt.experiments.lockstep.runtimes import build_unattended_runtime
from kurt2rt.runtime import Runtime

Difference = Literal["nothing", "stuck sensor", "set down elsewhere", "another world"]
"""Change against the drive from which the expectations were learned."""

_EXPERIMENTER = "experimenter"
_STUCK_FROM_S = 5.0
_REPOSITION_EVERY_S = 10.0


class StuckSensor(RobotProxy):
    """Proxy of a robot that freezes one of its infrared sensors."""

    def __init__(self, robot: Robot, sensor: int, from_s: float) -> None:
        """`sensor`: index in the robot's sensor table; stuck from `from_s` of the runtime's clock on."""
        super().__init__(robot)
        self._sensor = sensor
        self._from_s = from_s
        self._counts: int | None = None

    def sense(self, now_s: float) -> SensorReadings:
        """Return the robot's readings, with the stuck sensor at its count of `from_s`."""
        readings = self._robot.sense(now_s)
        if now_s < self._from_s:
            return readings
        counts = readings.infrared_counts
        if self._counts is None:
            self._counts = counts[self._sensor]
        stuck = (*counts[: self._sensor], self._counts, *counts[self._sensor + 1 :])
        return readings._replace(infrared_counts=stuck)


@dataclass(frozen=True, slots=True)
class SurpriseSetup:
    """World, seed, duration and change of one drive."""

    world: str
    difference: Difference
    seed: int
    duration_s: float
    purpose: str
    """Chooses start and noise together with the seed."""


@dataclass(frozen=True, slots=True)
class SurpriseCounts:
    """Counters of one drive."""

    difference: Difference
    ends: int
    """Ends of RLAs that had ended often enough before to be judged."""
    surprising: int
    new_follow_ups: int
    """Ends after which an RLA took over that never had before."""
    first_ends: int
    """First ends after a repositioning, unless the robot asked there."""
    surprising_first_ends: int
    share_unknown: float
    """Ratio of ticks in unknown situations, 0 to 1."""


async def drive(
    factory: SimulationFactory,
    settings: RobotSettings,
    task: TaskSettings,
    events: Sequence[TeachingEvent],
    saved: Statistics,
    setup: SurpriseSetup,
    on_progress: Callable[[float], None],
) -> tuple[SurpriseCounts, Statistics]:
    """Drive and continue to learn expectations; return the counters, and the statistics to continue from.

    Args:
        factory: opens the simulation.
        settings: of the robot.
        task: that the robot was taught.
        events: its lessons.
        saved: expectations of the drives before.
        setup: world, change and duration.
        on_progress: called once a second with the simulated seconds.

    Raises:
        hal.settings.SettingsError: task and world do not fit.
        UnknownActionError, UnknownBehaviourError: the lessons do not fit the task.
    """
    with closing(factory.open(setup.world, setup.seed, setup.purpose)) as simulation:
        chance = random.Random(f"surprise {setup.purpose} {setup.difference} {setup.seed}")
        sensor = chance.randrange(len(settings.infrared.names))
        robot = StuckSensor(simulation.robot, sensor, _STUCK_FROM_S) if setup.difference == "stuck sensor" else None
        runtime = build_unattended_runtime(simulation, settings, task, events, saved, robot)
        run = SurpriseRun(simulation, runtime, chance, setup.difference, on_progress)
        await run.run(round(setup.duration_s / run.period_s))
        return run.counts(), runtime.snapshot()


class SurpriseRun(Episode):
    """Episode that counts the surprising ends of RLAs."""

    def __init__(
        self,
        simulation: Simulation,
        runtime: Runtime,
        chance: random.Random,
        difference: Difference,
        on_progress: Callable[[float], None],
    ) -> None:
        super().__init__(
            simulation, runtime, chance, stuck_after_s=runtime.task.exam.stuck_after_s, on_progress=on_progress
        )
        self._difference = difference
        self._reposition_every = round(_REPOSITION_EVERY_S / self.period_s)
        self._ends = self._surprising = self._new_follow_ups = self._first_ends = self._surprising_first_ends = 0
        self._just_repositioned = False

    def on_tick(self, record: TickRecord) -> None:
        """Count surprises, and rescue or reposition the robot."""
        self._count_surprise(record)
        if record.guard_result.latched:
            self.simulation.rescue()
            self.send(Resume(self.next_id("go"), _EXPERIMENTER))
        self.measure()
        if self.metric.needs_reset:
            self.reposition()
        elif self.is_stuck():
            self.rescue()
        if self.metric.behaviour != record.behaviour:
            self.send(Pursue(self.next_id("wanted"), _EXPERIMENTER, self.metric.behaviour))
        if self._difference == "set down elsewhere" and record.tick % self._reposition_every == 1:
            self.reposition(in_sight=True)
            self._just_repositioned = True

    def counts(self) -> SurpriseCounts:
        """Return the counters of the drive so far."""
        return SurpriseCounts(
            self._difference,
            self._ends,
            self._surprising,
            self._new_follow_ups,
            self._first_ends,
            self._surprising_first_ends,
            self.unknown_ticks / max(self.ticks, 1),
        )

    def _count_surprise(self, record: TickRecord) -> None:
        surprise = record.surprise
        if surprise is not None:
            self._ends += 1
            self._surprising += surprise.surprising
            self._new_follow_ups += surprise.new_follow_up
            self._first_ends += self._just_repositioned
            self._surprising_first_ends += self._just_repositioned and surprise.surprising
        if surprise is not None or record.decision.asking:
            self._just_repositioned = False
