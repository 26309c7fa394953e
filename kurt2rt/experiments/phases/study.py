"""The programme, done: results of all jobs, put together."""

from collections.abc import Callable
from dataclasses import dataclass

from kurt2rt.experiments.phases.outcome import ExamOutcome, JobOutcome, StageOutcome
from kurt2rt.experiments.phases.plan import PhasesPlan
from kurt2rt.experiments.study.pool import Standing
from kurt2rt.experiments.study.results import Results
from kurt2rt.experiments.study.run_jobs import do_waves


@dataclass(frozen=True, slots=True)
class PhasesStudy:
    """All numbers."""

    programme: PhasesPlan
    stages: dict[str, tuple[StageOutcome, ...]]
    """By the name of the step, each in the order of the seeds."""
    teachers: tuple[tuple[ExamOutcome, ...], ...]
    """Drives of the teacher's own policy, per seed one in each world."""


def conduct(programme: PhasesPlan, results: Results, processes: int, on_standing: Callable[[Standing], None]) -> None:
    """Do the jobs that are missing, wave by wave; each leaves its result as soon as it is done.

    Raises StudyError and what a job raises.
    """
    do_waves(programme.waves, results, processes, on_standing)


def read_study(programme: PhasesPlan, results: Results) -> PhasesStudy:
    """Put together what all jobs have left. Raises StudyError."""
    stages: dict[str, list[StageOutcome]] = {}
    teachers = []
    for job in programme.jobs:
        outcome = results.read(job, JobOutcome)
        for stage in outcome.stages:
            stages.setdefault(stage.name, []).append(stage)
        if outcome.teachers:
            teachers.append(outcome.teachers)
    return PhasesStudy(programme, {name: tuple(each) for name, each in stages.items()}, tuple(teachers))
