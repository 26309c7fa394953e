"""What is to be done: the streets once for each robot, where they were not taught before, then its errands."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from hal.robot_settings import RobotSettings
from hal.simulation import SimulationFactory
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.compatibility import require_course
from kurt2rt.experiments.navigation.guided_tour import navigation_settings
from kurt2rt.experiments.navigation.job import ErrandsJob
from kurt2rt.experiments.navigation.outcome import ErrandsOutcome
from kurt2rt.experiments.navigation.robot_day import CONTROLS, PLANNING
from kurt2rt.experiments.route.job import BasicJob
from kurt2rt.experiments.route.plan import streets_of
from kurt2rt.experiments.study.pool import Standing
from kurt2rt.experiments.study.provenance import Fingerprints, source_hash
from kurt2rt.experiments.study.results import Results
from kurt2rt.experiments.study.run_jobs import do_waves, time_of_missing_s

DECIDING = (ErrandsJob,)
"""Classes whose code, and all that it imports, decides the results."""


@dataclass(frozen=True, slots=True)
class NavigationPlan:
    """Everything."""

    task: TaskSettings
    seeds: tuple[int, ...]
    basic_jobs: tuple[BasicJob, ...]
    """Empty where the streets were taught before."""
    jobs: tuple[ErrandsJob, ...]

    @property
    def waves(self) -> tuple[tuple[BasicJob | ErrandsJob, ...], ...]:
        """Jobs that need none but those of the waves before."""
        return self.basic_jobs, self.jobs


def plan(
    task: TaskSettings,
    basic: TaskSettings,
    seeds: Sequence[int],
    stage: SimulationFactory,
    robot: RobotSettings,
    results: Results,
    *,
    basic_folder: Path | None = None,
    controls: bool = False,
    source_of: Callable[[SimulationFactory], str] = lambda stage: source_hash(*DECIDING, type(stage)),
) -> NavigationPlan:
    """Look at task and worlds, and make the jobs.

    `basic`: the task that teaches the streets; `basic_folder`: files of robots that were taught it. `controls`: also
    without a plan. Raises hal.settings.SettingsError, StudyError, KnowledgeError.
    """
    worlds = (task.teaching.world, *task.exam.worlds[:1])
    navigation_settings(task)
    stage.require_worlds(*worlds, basic.teaching.world)
    require_course(stage, task, worlds)
    hows = (*PLANNING, *(CONTROLS if controls else ()))
    fingerprints = Fingerprints(stage, robot, source_of(stage), ("paper", "plain", "phases"))
    streets = streets_of(basic, seeds, stage, robot, results, fingerprints, basic_folder)
    jobs = []
    for seed in seeds:
        made = fingerprints.of(task, worlds, streets.made_of[seed], " ".join(hows))
        jobs.append(ErrandsJob(stage, robot, task, hows, seed, streets.files[seed], made, results))
    return NavigationPlan(task, tuple(seeds), streets.jobs, tuple(jobs))


def robot_time_s(programme: NavigationPlan, results: Results) -> float:
    """What is still to be simulated. Raises StudyError."""
    return time_of_missing_s(programme.waves, results)


def conduct(
    programme: NavigationPlan, results: Results, processes: int, on_standing: Callable[[Standing], None]
) -> None:
    """Do the jobs that are missing, wave by wave. Raises StudyError and what a job raises."""
    do_waves(programme.waves, results, processes, on_standing)


def read_outcomes(programme: NavigationPlan, results: Results) -> tuple[ErrandsOutcome, ...]:
    """What all jobs have left. Raises StudyError."""
    return tuple(results.read(job, ErrandsOutcome) for job in programme.jobs)
