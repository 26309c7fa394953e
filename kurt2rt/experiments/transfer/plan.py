"""Plan of the transfer study: each robot is taught at home, then on in each new world by each variant."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from hal.robot_settings import RobotSettings
from hal.settings import SettingsError
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.compatibility import require_course
from kurt2rt.experiments.study.jobs import JobParts, StudyJob
from kurt2rt.experiments.study.loop_choice import ALL_ON_BUS, NO_CHOICE, LoopChoice, RequestedLoops, choose_loops
from kurt2rt.experiments.study.provenance import Fingerprints
from kurt2rt.experiments.study.results import Results
from kurt2rt.experiments.transfer.jobs import HomeJob, TransferJob
from kurt2rt.experiments.transfer.outcome import HomeOutcome, TransferOutcome
from kurt2rt.experiments.transfer.variants import TAUGHT_ON, Variant

SEED = "SEED"
"""Part of a world's name that stands for the robot's seed."""
AFTER = (0, 2, 5, 10, 15, 20)
"""Numbers of presses after which a robot is examined."""


@dataclass(frozen=True, slots=True)
class TransferExperiment:
    """Robots in one kind of new world, taught there by one variant: a job for each seed."""

    place: str
    """Name of the new world, with SEED where it is another world for each robot."""
    variant: Variant
    jobs: tuple[TransferJob, ...]


@dataclass(frozen=True, slots=True)
class TransferPlan:
    """Jobs of the study, in the order of the tables."""

    task: TaskSettings
    seeds: tuple[int, ...]
    after: tuple[int, ...]
    home_jobs: tuple[HomeJob, ...]
    experiments: tuple[TransferExperiment, ...]
    choice: LoopChoice = NO_CHOICE
    """Loops of the jobs."""

    @property
    def transfer_jobs(self) -> tuple[TransferJob, ...]:
        """Jobs in the new worlds."""
        return tuple(job for each in self.experiments for job in each.jobs)

    @property
    def waves(self) -> tuple[tuple[StudyJob, ...], ...]:
        """Jobs and their witnesses in waves; the jobs of a wave need only results of earlier waves."""
        home, there = self.home_jobs, self.transfer_jobs
        return (*home, *self.choice.witnesses(home)), (*there, *self.choice.witnesses(there))

    def driven(self, loops: RequestedLoops, robot: RobotSettings) -> "TransferPlan":
        """Return the plan with jobs that these loops drive. Raises hal.settings.SettingsError."""
        choice = choose_loops((*self.home_jobs, *self.transfer_jobs), loops, robot)
        return replace(
            self,
            home_jobs=choice.apply(self.home_jobs),
            experiments=tuple(replace(each, jobs=choice.apply(each.jobs)) for each in self.experiments),
            choice=choice,
        )


@dataclass(frozen=True, slots=True)
class NewWorlds:
    """New worlds and the lessons there."""

    places: tuple[str, ...]
    """Names of worlds; SEED in a name stands for the robot's seed."""
    after: tuple[int, ...] = AFTER
    """Numbers of presses after which a robot is examined, ascending."""
    seconds: float | None = None
    """Longest time of teaching in s; None: that of the lesson at home."""


def make_plan(
    task: TaskSettings,
    new: NewWorlds,
    seeds: Sequence[int],
    variants: Sequence[Variant],
    parts: JobParts,
    *,
    loops: RequestedLoops = ALL_ON_BUS,
) -> TransferPlan:
    """Check task and worlds, and return the jobs.

    Args:
        task: to teach, in its own world and in the new ones.
        new: new worlds.
        seeds: one robot each.
        variants: ways of teaching in the new worlds.
        parts: factory, robot and results of the jobs.
        loops: requested for lessons and exams; lessons in new worlds are given on the CAN bus.

    Raises:
        hal.settings.SettingsError: the task and a world do not fit, or a new world is that of home.
    """
    factory = parts["factory"]
    home, seconds = task.teaching.world, new.seconds or task.teaching.duration_s
    worlds = {(place, seed): place.replace(SEED, str(seed)) for place in dict.fromkeys(new.places) for seed in seeds}
    if home in worlds.values():
        raise SettingsError("is the world of home, not a new one", where=f"world {home}", do="name another one")
    needed = tuple(dict.fromkeys((home, *worlds.values())))
    factory.require_worlds(*needed)
    require_course(factory, task, needed)
    fingerprints = Fingerprints(factory, parts["robot"], ("paper", "plain", "phases"))
    made_at_home = fingerprints.of(task, (home,))
    home_jobs = {seed: HomeJob(task=task, seed=seed, made_of=made_at_home, **parts) for seed in seeds}

    def job(place: str, variant: Variant, seed: int) -> TransferJob:
        world = worlds[place, seed]
        own = variant.task(task, world).teaching.model_dump_json(serialize_as_any=True)
        lesson = repr((variant, new.after, seconds))
        return TransferJob(
            task=task,
            seed=seed,
            variant=variant,
            world=world,
            place=_file_name(place),
            after=new.after,
            seconds=seconds,
            home=home_jobs[seed],
            made_of=fingerprints.of(task, (home, world), own, lesson),
            **parts,
        )

    plan = TransferPlan(
        task,
        tuple(seeds),
        new.after,
        tuple(home_jobs.values()),
        tuple(
            TransferExperiment(place, variant, tuple(job(place, variant, seed) for seed in seeds))
            for place in dict.fromkeys(new.places)
            for variant in variants
        ),
    )
    return plan.driven(loops, parts["robot"])


@dataclass(frozen=True, slots=True)
class TransferSummary:
    """Experiment with its outcomes."""

    experiment: TransferExperiment
    outcomes: tuple[TransferOutcome, ...]
    """One per robot, in the order of the seeds."""

    @property
    def judged(self) -> tuple[TransferOutcome, ...]:
        """Outcomes whose exams in the new world have verdicts."""
        return tuple(each for each in self.outcomes if each.judged)

    @property
    def studied(self) -> bool:
        """True if it is no control."""
        return self.experiment.variant.name == TAUGHT_ON.name

    def right_after(self, presses: int) -> int:
        """Return the number of robots that pass the exam in the new world after so many presses."""
        return sum(point.drive.passed for each in self.judged for point in each.checkpoints if point.presses == presses)

    def right_by(self, presses: int) -> int:
        """Return the number of robots that pass an exam in the new world after so many presses or fewer."""
        return sum(each.presses_until_right <= presses for each in self.judged)


@dataclass(frozen=True, slots=True)
class TransferStudy:
    """Plan and outcomes of the study."""

    plan: TransferPlan
    home: tuple[HomeOutcome, ...]
    """One per robot, in the order of the seeds."""
    summaries: tuple[TransferSummary, ...]


def read_study(plan: TransferPlan, results: Results) -> TransferStudy:
    """Read the results of all jobs of the plan. Raises StudyError if a result is missing or damaged."""
    return TransferStudy(
        plan,
        tuple(results.read(job, HomeOutcome) for job in plan.home_jobs),
        tuple(
            TransferSummary(each, tuple(results.read(job, TransferOutcome) for job in each.jobs))
            for each in plan.experiments
        ),
    )


def _file_name(place: str) -> str:
    """Return the name of a world, which may be a path, as one part of a file name."""
    return re.sub(r"[^A-Za-z0-9_-]+", "-", Path(place).with_suffix("").as_posix()).strip("-")
