"""Runner of a study: stored jobs in waves, of which the missing ones are run, here or on other machines."""

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Protocol

from kurt2rt.experiments.study.pool import Job, JobKilledError, JobProcesses, PoolProgress
from kurt2rt.experiments.study.results import Results, StoredResult, StudyError


class StoredJob(StoredResult, Job, Protocol):
    """Job that leaves its result in a file."""

    @property
    def seed(self) -> int:
        """Seed of the robot; jobs of other robots need none of its files."""
        ...

    @property
    def knowledge_name(self) -> str | None:
        """Path of the stored knowledge within the folder of results; None: the job stores none."""
        ...


class Executor(Protocol):
    """Runner of jobs, here or on other machines; each job leaves its result in the folder of results here."""

    def run(
        self,
        jobs: Sequence[StoredJob],
        earlier: Mapping[int, Sequence[StoredJob]],
        results: Results,
        on_progress: Callable[[PoolProgress], None],
    ) -> None:
        """Run all jobs, of which none needs another.

        Args:
            earlier: jobs that are done, by the seed of their robot.
            results: folder of results.
            on_progress: gets the progress of all jobs.

        Raises:
            JobKilledError: the worker of a job was killed again and again.
            Exception: any error of a job.
        """
        ...


@contextmanager
def open_processes(count: int) -> Iterator[Executor]:
    """Yield an executor with at most so many processes of this machine, 1: this one; end them."""
    with JobProcesses(count) as processes:
        yield LocalExecutor(processes)


class LocalExecutor:
    """Runner of jobs in processes of this machine, which find the files of earlier jobs in the folder of results."""

    def __init__(self, processes: JobProcesses) -> None:
        """Take the processes that run the jobs; they are kept from one wave to the next."""
        self._processes = processes

    def run(
        self,
        jobs: Sequence[StoredJob],
        earlier: Mapping[int, Sequence[StoredJob]],  # noqa: ARG002 - their files are here
        results: Results,  # noqa: ARG002 - each job knows its folder
        on_progress: Callable[[PoolProgress], None],
    ) -> None:
        """Run all jobs (`Executor.run`). Raises JobKilledError, and any error of a job."""
        self._processes.run(jobs, on_progress)


Waves = Sequence[Sequence[StoredJob]]
"""Jobs of a study in waves, each of which needs only the waves before."""


def missing_time_s(waves: Waves, results: Results) -> float:
    """Return the robot time of all jobs without a result, in s.

    Raises StudyError if there are results of other settings, source or versions, or damaged files.
    """
    return sum(wave[place].robot_time_s for wave in waves for place in results.missing(wave))


def run_missing(
    waves: Waves,
    results: Results,
    executor: Executor,
    on_progress: Callable[[PoolProgress], None],
) -> None:
    """Run the jobs without a result, wave by wave; each stores its result as soon as it is done.

    Args:
        executor: runs the jobs, here or on other machines.
        on_progress: called with the progress of all waves together.

    Raises:
        StudyError: a process was killed, or results of other settings are in the folder.
        Exception: any error of a job.
    """
    before_s = 0.0
    earlier: dict[int, list[StoredJob]] = defaultdict(list)
    for wave in waves:
        jobs = [wave[place] for place in results.missing(wave)]

        def update(progress: PoolProgress, before_s: float = before_s) -> None:
            on_progress(PoolProgress(before_s + progress.done_s, progress.running))

        try:
            executor.run(jobs, earlier, results, update)
        except JobKilledError as error:
            raise StudyError(
                f"{error}", do="run again, it goes on where it was (with fewer --jobs it needs less)"
            ) from error
        before_s += sum(job.robot_time_s for job in jobs)
        for job in wave:
            earlier[job.seed].append(job)
