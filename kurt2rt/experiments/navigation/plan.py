"""Plan of the navigation study: the streets of each robot, unless taught before, then its goals."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.compatibility import require_course
from kurt2rt.experiments.navigation.guided_tour import navigation_settings
from kurt2rt.experiments.navigation.jobs import NavigationJob
from kurt2rt.experiments.navigation.outcome import ErrandsOutcome
from kurt2rt.experiments.navigation.robot_day import CONTROLS, PLANNING
from kurt2rt.experiments.route.jobs import BasicJob
from kurt2rt.experiments.route.plan import streets_of
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.provenance import Fingerprints
from kurt2rt.experiments.study.results import Results


@dataclass(frozen=True, slots=True)
class NavigationPlan:
    """Jobs of the study."""

    task: TaskSettings
    seeds: tuple[int, ...]
    basic_jobs: tuple[BasicJob, ...]
    """Empty where the streets were taught before."""
    jobs: tuple[NavigationJob, ...]

    @property
    def waves(self) -> tuple[tuple[BasicJob | NavigationJob, ...], ...]:
        """Jobs in waves; the jobs of a wave need only results of earlier waves."""
        return self.basic_jobs, self.jobs


def make_plan(
    task: TaskSettings,
    basic: TaskSettings,
    seeds: Sequence[int],
    parts: JobParts,
    *,
    basic_folder: Path | None = None,
    controls: bool = False,
) -> NavigationPlan:
    """Check task and worlds, and return the jobs.

    Args:
        task: with errands.
        basic: the task that teaches the streets.
        seeds: one robot each.
        parts: factory, robot and results of the jobs.
        basic_folder: files of robots that were taught `basic`; None: the streets are taught first.
        controls: whether to drive also without a plan.

    Raises:
        hal.settings.SettingsError: a task and a world do not fit.
        StudyError: a knowledge file is missing.
        KnowledgeError: a knowledge file cannot be read.
    """
    factory, robot, results = parts["factory"], parts["robot"], parts["results"]
    worlds = (task.teaching.world, *task.exam.worlds[:1])
    navigation_settings(task)
    factory.require_worlds(*worlds, basic.teaching.world)
    require_course(factory, task, worlds)
    strategies = (*PLANNING, *(CONTROLS if controls else ()))
    fingerprints = Fingerprints(factory, robot, ("paper", "plain", "phases"))
    streets = streets_of(basic, seeds, factory, robot, results, fingerprints, basic_folder)
    jobs = []
    for seed in seeds:
        made = fingerprints.of(task, worlds, streets.made_of[seed], " ".join(strategies))
        jobs.append(
            NavigationJob(
                factory=factory,
                robot=robot,
                task=task,
                strategies=strategies,
                seed=seed,
                basic=streets.files[seed],
                made_of=made,
                results=results,
            )
        )
    return NavigationPlan(task, tuple(seeds), streets.jobs, tuple(jobs))


def read_outcomes(plan: NavigationPlan, results: Results) -> tuple[ErrandsOutcome, ...]:
    """Return the outcomes of all jobs, robot by robot. Raises StudyError if a result is missing or damaged."""
    return tuple(results.read(job, ErrandsOutcome) for job in plan.jobs)
