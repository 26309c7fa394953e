"""Does jobs that each leave their own result."""

from collections.abc import Callable, Sequence
from typing import Protocol

from kurt2rt.experiments.study.pool import Job, JobKilledError, Standing, run_jobs
from kurt2rt.experiments.study.results import Results, StoredResult, StudyError


class StoredJob(StoredResult, Job[None], Protocol):
    """A job that leaves its result in a file."""


def do_jobs(jobs: Sequence[Job[None]], processes: int, on_standing: Callable[[Standing], None]) -> None:
    """Run them; what is done stays done, whatever happens to the others. Raises StudyError and what a job raises."""
    try:
        run_jobs(jobs, processes, on_standing=on_standing)
    except JobKilledError as error:
        raise StudyError(
            f"{error}", do="run again, it goes on where it was (with fewer --jobs it needs less)"
        ) from error


def time_of_missing_s(waves: Sequence[Sequence[StoredJob]], results: Results) -> float:
    """Robot time that is still to be simulated. Raises StudyError."""
    return sum(wave[place].robot_time_s for wave in waves for place in results.missing(wave))


def do_waves(
    waves: Sequence[Sequence[StoredJob]], results: Results, processes: int, on_standing: Callable[[Standing], None]
) -> None:
    """Do the jobs that are missing, wave by wave, for each needs only those before it.

    `on_standing` hears of all waves together. Raises as `do_jobs`.
    """
    before_s = 0.0
    for wave in waves:
        jobs = [wave[place] for place in results.missing(wave)]

        def look(standing: Standing, before_s: float = before_s) -> None:
            on_standing(Standing(before_s + standing.done_s, standing.running))

        do_jobs(jobs, processes, look)
        before_s += sum(job.robot_time_s for job in jobs)
