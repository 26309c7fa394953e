"""Study of one task: the same curriculum for many seeds."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.study.jobs import CurriculumJob, ExaminedOutcome, JobParts, Progress, curriculum_time_s
from kurt2rt.experiments.study.provenance import Fingerprints
from kurt2rt.experiments.study.study_plan import EngineRequest, StudyPlan
from kurt2rt.knowledge.files.archive_existing import archive_existing


@dataclass(frozen=True, slots=True, kw_only=True)
class SeedJob(CurriculumJob):
    """Job of `kurt2rt train --seeds` that teaches and examines the robot of one seed.

    An earlier knowledge file of the robot gets a new name.
    """

    replaces_others: ClassVar[bool] = True

    @property
    def knowledge_name(self) -> str:
        """Path of the stored knowledge within the folder of results."""
        return f"{self.stem}.knowledge"

    def run(self, on_progress: Progress) -> None:
        """Run the job, and store result and knowledge (`StudyJob.run`)."""
        archive_existing(self.knowledge)
        super(SeedJob, self).run(on_progress)


def make_plan(
    task: TaskSettings, seeds: Sequence[int], parts: JobParts, *, engine: EngineRequest = EngineRequest.CAN
) -> StudyPlan[None]:
    """Return the jobs that teach and examine a robot of each seed; raises SettingsError for settings of no use."""
    made = Fingerprints(parts["factory"], parts["robot"]).of(task, (task.teaching.world, *task.exam.worlds))
    jobs = [
        SeedJob(
            **parts,
            task=task,
            seed=seed,
            made_of=made,
            name=f"{task.name}, seed {seed}",
            stem=f"{task.name}-{seed}",
            robot_time_s=curriculum_time_s(task, len(task.exam.worlds)),
            worlds=task.exam.worlds,
        )
        for seed in seeds
    ]
    return StudyPlan(None, tuple(seeds), tuple(jobs)).driven(engine, parts["robot"])


def forget_lost_robots(plan: StudyPlan[None]) -> None:
    """Delete each result whose robot has no knowledge file, because its robot is taught again. Raises OSError."""
    for job in plan.jobs:
        if not job.knowledge.exists():
            forget_result(job.results.folder, job.task.name, job.seed)


def forget_result(folder: Path, task: str, seed: int) -> None:
    """Delete the result of the robot whose knowledge file gets another content. Raises OSError."""
    (folder / f"results/{task}-{seed}.json").unlink(missing_ok=True)


def read_results(plan: StudyPlan[None]) -> list[ExaminedOutcome]:
    """Return the outcomes, in the order of the seeds. Raises StudyError if one is missing or damaged."""
    return [job.results.read(job, ExaminedOutcome) for job in plan.jobs]
