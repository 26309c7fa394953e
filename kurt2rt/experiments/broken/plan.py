"""Plan of the study of broken sensors: the jobs of all robots, and their outcomes."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from hal.settings import SettingsError
from hal.simulation import SimulationFactory
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.broken.drive import Driver
from kurt2rt.experiments.broken.jobs import HealthyJob, SensorJob
from kurt2rt.experiments.broken.outcome import HealthyOutcome, SensorOutcome
from kurt2rt.experiments.lockstep.compatibility import require_course
from kurt2rt.experiments.lockstep.faulty_sensor import FaultKind
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.provenance import Fingerprints, settings_hash, source_hash
from kurt2rt.experiments.study.results import Results
from kurt2rt.knowledge.journal.loading import read_lessons

DECIDING = (SensorJob, HealthyJob)
"""Classes whose code, and all that it imports, decides the results."""
SEED = "SEED"
"""Part of a world's name that stands for the robot's seed."""


@dataclass(frozen=True, slots=True)
class BrokenDrives:
    """Robots, worlds, sensors, faults and times of the study."""

    taught: Path
    """Folder with a knowledge file for each seed."""
    seeds: tuple[int, ...]
    worlds: tuple[str, ...]
    """Worlds of the faults: the sensors of a robot take them in turn."""
    healthy_worlds: tuple[str, ...]
    """Worlds of drives in which all sensors work."""
    sensors: tuple[int, ...]
    """Places in the sensor table."""
    faults: tuple[FaultKind, ...]
    longest_s: float
    after_s: float
    healthy_s: float
    """Time of each drive in which all sensors work, in s; 0: none."""


@dataclass(frozen=True, slots=True)
class BrokenPlan:
    """Jobs of the study."""

    drives: BrokenDrives
    sensor_jobs: tuple[SensorJob, ...]
    healthy_jobs: tuple[HealthyJob, ...]

    @property
    def waves(self) -> tuple[tuple[SensorJob | HealthyJob, ...], ...]:
        """All jobs in one wave."""
        return ((*self.sensor_jobs, *self.healthy_jobs),)


@dataclass(frozen=True, slots=True)
class BrokenStudy:
    """Plan and outcomes of the study."""

    plan: BrokenPlan
    sensors: tuple[SensorOutcome, ...]
    healthy: tuple[HealthyOutcome, ...]


def make_plan(
    task: TaskSettings,
    drives: BrokenDrives,
    parts: JobParts,
    *,
    source_of: Callable[[SimulationFactory], str] = lambda factory: source_hash(*DECIDING, type(factory)),
) -> BrokenPlan:
    """Check knowledge, task and worlds, and return the jobs.

    Args:
        task: that the robots were taught.
        drives: robots, worlds, sensors and faults.
        parts: factory, robot and results of the jobs.
        source_of: returns the hash of the program's source.

    Raises:
        KnowledgeError: a knowledge file is missing or cannot be read.
        hal.settings.SettingsError: task and worlds do not fit.
    """
    factory, robot = parts["factory"], parts["robot"]
    files = {seed: drives.taught / f"{task.name}-{seed}.knowledge" for seed in drives.seeds}
    knowledge = {seed: repr(read_lessons(path, robot, task)) for seed, path in files.items()}
    every = (*drives.worlds, *(drives.healthy_worlds if drives.healthy_s else ()))
    needed = tuple(dict.fromkeys(world.replace(SEED, str(seed)) for world in every for seed in drives.seeds))
    factory.require_worlds(*needed)
    require_course(factory, task, needed)
    fingerprints = Fingerprints(factory, robot, source_of(factory))
    sensor_jobs, healthy_jobs = [], []
    for seed in drives.seeds:
        taught = settings_hash(knowledge[seed])
        for sensor in drives.sensors:
            place = drives.worlds[(seed + sensor) % len(drives.worlds)]
            world = place.replace(SEED, str(seed))
            times = repr((drives.faults, drives.longest_s, drives.after_s))
            sensor_jobs.append(
                SensorJob(
                    task=task,
                    knowledge=files[seed],
                    seed=seed,
                    world=world,
                    place=_file_name(place),
                    sensor=sensor,
                    faults=drives.faults,
                    longest_s=drives.longest_s,
                    after_s=drives.after_s,
                    made_of=fingerprints.of(task, (world,), taught, times),
                    **parts,
                )
            )
        for place in drives.healthy_worlds if drives.healthy_s else ():
            world = place.replace(SEED, str(seed))
            healthy_jobs += [
                HealthyJob(
                    task=task,
                    knowledge=files[seed],
                    seed=seed,
                    world=world,
                    place=_file_name(place),
                    driver=driver,
                    seconds=drives.healthy_s,
                    made_of=fingerprints.of(task, (world,), taught, repr((driver, drives.healthy_s))),
                    **parts,
                )
                for driver in (Driver.RLAS, Driver.PRESSES)
            ]
    return BrokenPlan(drives, tuple(sensor_jobs), tuple(healthy_jobs))


def read_study(plan: BrokenPlan, results: Results) -> BrokenStudy:
    """Read the results of all jobs of the plan. Raises StudyError if a result is missing or damaged."""
    return BrokenStudy(
        plan,
        tuple(results.read(job, SensorOutcome) for job in plan.sensor_jobs),
        tuple(results.read(job, HealthyOutcome) for job in plan.healthy_jobs),
    )


def chosen_sensors(names: Sequence[str], wanted: Sequence[str] | None) -> tuple[int, ...]:
    """Return the places of the wanted sensors in the table of `names`; all of them for None. Raises SettingsError."""
    unknown = [name for name in wanted or () if name not in names]
    if unknown:
        raise SettingsError(f"no sensor of the robot (allowed {', '.join(names)})", where=f"sensor {unknown[0]}")
    return tuple(range(len(names))) if not wanted else tuple(names.index(name) for name in dict.fromkeys(wanted))


def _file_name(place: str) -> str:
    """Return the name of a world, which may be a path, as one part of a file name."""
    return re.sub(r"[^A-Za-z0-9_-]+", "-", Path(place).with_suffix("").as_posix()).strip("-")
