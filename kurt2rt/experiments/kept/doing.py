"""Does jobs that each leave their own result."""

from collections.abc import Callable, Sequence

from kurt2rt.experiments.error import JobKilledError, StudyError
from kurt2rt.experiments.pool import Job, Standing, run_jobs


def do_jobs(jobs: Sequence[Job[None]], processes: int, on_standing: Callable[[Standing], None]) -> None:
    """Run them; what is done stays done, whatever happens to the others. Raises StudyError and what a job raises."""
    try:
        run_jobs(jobs, processes, on_standing=on_standing)
    except JobKilledError as error:
        raise StudyError(f"{error}; run again, it goes on where it was (with fewer --jobs it needs less)") from error
