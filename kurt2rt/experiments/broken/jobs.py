"""Jobs of the study of broken sensors: one sensor of one robot with each fault, and drives of working sensors."""

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import anyio

from hal.settings import Settings
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.experiments.broken.drive import Driver, DriveSetup, drive
from kurt2rt.experiments.broken.outcome import FaultDrive, HealthyOutcome, SensorOutcome
from kurt2rt.experiments.lockstep.faulty_sensor import BREAKS_AT_S, FaultKind
from kurt2rt.experiments.study.jobs import SimulationJob
from kurt2rt.experiments.study.pool import Progress
from kurt2rt.knowledge.journal.loading import read_lessons


@dataclass(frozen=True, slots=True, kw_only=True)
class _Job(SimulationJob):
    """Drives of one taught robot."""

    knowledge: Path
    seed: int
    world: str
    place: str
    """World, for file names."""

    @abstractmethod
    async def measure(self, events: Sequence[TeachingEvent], tell: Progress) -> Settings:
        """Drive with these lessons and return the outcome; `tell` gets the simulated seconds. Raises SettingsError."""

    def run(self, tell: Progress) -> None:
        """Run the job and store its outcome; `tell` gets the simulated seconds so far.

        Raises KnowledgeError, SettingsError, and OSError if the result cannot be stored.
        """
        events = read_lessons(self.knowledge, self.robot, self.task)
        self.results.write(self, anyio.run(self.measure, events, tell))


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorJob(_Job):
    """One sensor with each fault: the robot's drive, and the policy's from the same start, equally long."""

    outcome = SensorOutcome
    sensor: int
    """Place in the sensor table."""
    faults: tuple[FaultKind, ...]
    longest_s: float
    """Longest time of driving until the notice, in s."""
    after_s: float
    """Time that is driven after Go, in s."""

    @property
    def sensor_name(self) -> str:
        """Name of the sensor, such as s15."""
        return self.robot.infrared.names[self.sensor]

    @property
    def name(self) -> str:
        """Name in progress displays."""
        return f"{self.task.name}, seed {self.seed}, {self.sensor_name} in {self.world}"

    @property
    def file(self) -> str:
        """Path of the result within the folder of results."""
        return f"results/{self.place}/{self.task.name}-{self.seed}-{self.sensor_name}.json"

    @property
    def robot_time_s(self) -> float:
        """Simulated time in s, about."""
        return len(self.faults) * self._fault_s

    @property
    def _fault_s(self) -> float:
        return 2 * (BREAKS_AT_S + self.longest_s + self.after_s)

    async def measure(self, events: Sequence[TeachingEvent], tell: Progress) -> SensorOutcome:
        """Drive with each fault and return the outcome; `tell` gets the simulated seconds. Raises SettingsError."""
        drives = []
        for fault in self.faults:
            drives.append(await self._drive_with(fault, events))
            tell(len(drives) * self._fault_s)
        return SensorOutcome(
            made_of=self.made_of, seed=self.seed, world=self.world, sensor=self.sensor_name, drives=tuple(drives)
        )

    async def _drive_with(self, fault: FaultKind, events: Sequence[TeachingEvent]) -> FaultDrive:
        parts = self.factory, self.robot, self.task, events
        setup = DriveSetup(self.world, self.seed, Driver.RLAS, self.longest_s, self.after_s, self.sensor, fault)
        run = await drive(*parts, setup)
        own = DriveSetup(self.world, self.seed, Driver.POLICY, self.longest_s, self.after_s, self.sensor, fault)
        policy = await drive(*parts, own, end_tick=run.ticks)
        before = run.collisions_until(run.noticed_at)
        return FaultDrive(
            fault=fault,
            noticed=run.noticed,
            driven_s=run.driven_s,
            misled_s=run.misled_s,
            wrong=tuple(name for name, _ in run.named),
            asks=run.asks,
            collisions_before=before,
            collisions_after=run.collisions_until(None) - before,
            after_s=0.0 if run.went_on_at is None else (run.ticks - run.went_on_at) * run.period_s,
            policy_collisions=policy.collisions_until(None),
            policy_before=policy.collisions_until(run.noticed_at),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class HealthyJob(_Job):
    """Drive of a robot whose sensors work."""

    outcome = HealthyOutcome
    driver: Driver
    seconds: float
    """Time of the drive in s."""

    @property
    def name(self) -> str:
        """Name in progress displays."""
        return f"{self.task.name}, seed {self.seed}, healthy in {self.world}, {self.driver}"

    @property
    def file(self) -> str:
        """Path of the result within the folder of results."""
        return f"results/{self.place}/{self.task.name}-{self.seed}-healthy-{self.driver}.json"

    @property
    def robot_time_s(self) -> float:
        """Simulated time in s, about."""
        return self.seconds

    async def measure(self, events: Sequence[TeachingEvent], tell: Progress) -> HealthyOutcome:
        """Drive and return the outcome; `tell` gets the simulated seconds. Raises SettingsError."""
        setup = DriveSetup(self.world, self.seed, self.driver, self.seconds)
        end_tick = round(self.seconds / self.robot.cycle_s)
        run = await drive(self.factory, self.robot, self.task, events, setup, end_tick)
        tell(self.seconds)
        return HealthyOutcome(
            made_of=self.made_of,
            seed=self.seed,
            world=self.world,
            driver=self.driver,
            driven_s=run.driven_s,
            named=tuple(f"{name} {sign}" for name, sign in run.named),
            collisions=run.collisions_until(None),
        )
