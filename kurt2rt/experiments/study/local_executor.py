"""Executor of this machine: processes that are kept from one wave of jobs to the next."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager

from kurt2rt.experiments.study.plan import StoredJob
from kurt2rt.experiments.study.pool import JobProcesses, PoolProgress
from kurt2rt.experiments.study.results import Results


class LocalExecutor:
    """Runner of jobs in processes of this machine, which find the files of earlier jobs in the folder of results."""

    def __init__(self, processes: JobProcesses) -> None:
        """Take the processes that run the jobs."""
        self._processes = processes

    def run(
        self,
        jobs: Sequence[StoredJob],
        earlier: Mapping[int, Sequence[StoredJob]],  # noqa: ARG002 - their files are here
        results: Results,  # noqa: ARG002 - each job knows its folder
        on_progress: Callable[[PoolProgress], None],
    ) -> None:
        """Run all jobs (`Executor.run`). Raises JobKilledError, and any error of a job."""
        self._processes.run(jobs, on_progress=on_progress)


@contextmanager
def open_processes(count: int) -> Iterator[LocalExecutor]:
    """Yield an executor with at most so many processes, 1: this one; end them."""
    with JobProcesses(count) as processes:
        yield LocalExecutor(processes)
