"""Runner of a study: jobs in waves, of which the missing ones run in parallel processes or on other machines."""

import multiprocessing
import os
import signal
import threading
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, MutableMapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import connection
from multiprocessing.managers import SyncManager
from multiprocessing.process import BaseProcess
from typing import NamedTuple, Protocol

from threadpoolctl import threadpool_limits

from config.errors import ExitCode, UserError
from kurt2rt.experiments.study.jobs import Progress, Results, StoredJob, StudyError
from kurt2rt.platform.gc_control import freeze_survivors, unfrozen_at_end

_LOOK_EVERY_S = 0.5
_TELL_EVERY_S = 5.0


class JobKilledError(UserError):
    """Process of a job that was killed from outside; the message names the job."""


class PoolProgress(NamedTuple):
    """Progress of the jobs that a pool runs, for a progress bar."""

    done_s: float
    """Robot time so far, in s."""
    running: tuple[str, ...]
    """Names of the running jobs."""


def _run_here(jobs: Sequence[StoredJob], on_progress: Callable[[PoolProgress], None]) -> None:
    before_s = 0.0
    with unfrozen_at_end():
        for job in jobs:
            on_progress(PoolProgress(before_s, (job.name,)))

            def tell(done_s: float, job: StoredJob = job, before_s: float = before_s) -> None:
                on_progress(PoolProgress(before_s + done_s, (job.name,)))

            freeze_survivors()
            with threadpool_limits(limits=1), _named(job):
                job.run(_now_and_then(tell))
            before_s += job.robot_time_s
    on_progress(PoolProgress(before_s, ()))


class Executor(Protocol):
    """Runner of jobs, here or on other machines; each job leaves its result in the folder of results here."""

    def run(
        self,
        jobs: Sequence[StoredJob],
        earlier: Mapping[int, Sequence[StoredJob]],
        results: Results,
        on_progress: Callable[[PoolProgress], None],
    ) -> None:
        """Run all jobs of a wave, of which none needs another; the longest begin first.

        `earlier`: jobs that are done, by the seed of their robot. `results`: folder of results. Raises JobKilledError
        if the process or the workers of a job were killed, and any error of a job.
        """


@contextmanager
def open_processes(count: int) -> Iterator[Executor]:
    """Yield an executor with at most so many processes of this machine, 1: this one; end them."""
    processes = JobProcesses(count)
    try:
        yield processes
    finally:
        processes.end()


class JobProcesses:
    """Processes of this machine that run the jobs of several waves, whose earlier results are in their folder.

    They are started for the first wave of more than one job, and kept: each takes seconds to import what a job needs.
    """

    def __init__(self, processes: int) -> None:
        """Run at most `processes` jobs at once; 1: jobs run in this process."""
        self._processes = processes
        # Fresh interpreters: a fork would share the parent's threads and buses half-way.
        self._context = multiprocessing.get_context("spawn")
        self._manager: SyncManager | None = None
        self._pool: ProcessPoolExecutor | None = None
        self._others: set[BaseProcess] = set()
        self._begun: set[BaseProcess] = set()

    def end(self) -> None:
        """End all processes."""
        if self._pool is not None:
            self._pool.shutdown()
        if self._manager is not None:
            self._manager.shutdown()

    def run(
        self,
        jobs: Sequence[StoredJob],
        earlier: Mapping[int, Sequence[StoredJob]],  # noqa: ARG002 - their files are here
        results: Results,  # noqa: ARG002 - each job knows its folder
        on_progress: Callable[[PoolProgress], None],
    ) -> None:
        """Run all jobs (`Executor.run`), with one process in this one; after an error no others can be run.

        The first error of a job ends all other jobs, and so does Ctrl-C; the error's notes name the job. `on_progress`
        gets the progress of all jobs twice a second. Raises JobKilledError, and any error of a job.
        """
        # The longest last would leave the other processes idle at the end.
        ordered = sorted(jobs, key=lambda job: -job.robot_time_s)
        if self._processes == 1 or len(jobs) <= 1:
            _run_here(ordered, on_progress)
        else:
            self._run_apart(ordered, on_progress)

    def _started(self) -> tuple[ProcessPoolExecutor, SyncManager]:
        if self._pool is None or self._manager is None:
            self._manager = SyncManager(ctx=self._context)
            self._manager.start(_belong_to_the_parent)
            self._others = set(multiprocessing.active_children())
            self._pool = ProcessPoolExecutor(
                self._processes, mp_context=self._context, initializer=_belong_to_the_parent
            )
        return self._pool, self._manager

    def _run_apart(self, jobs: Sequence[StoredJob], on_progress: Callable[[PoolProgress], None]) -> None:
        pool, manager = self._started()
        clocks, workers = manager.dict(), manager.dict()
        places: dict[Future[None], int] = {}
        """Indexes of the jobs that are not through."""
        try:
            for place, job in enumerate(jobs):
                places[pool.submit(_run_in_worker, job, place, clocks, workers)] = place
                self._begun.update(set(multiprocessing.active_children()) - self._others)
            while places:
                done, _ = wait(places, timeout=_LOOK_EVERY_S, return_when=FIRST_COMPLETED)
                for future in done:
                    with _named(jobs[places[future]]):
                        future.result()
                    del places[future]
                on_progress(_pool_progress(jobs, list(places.values()), self._processes, clocks))
        except BrokenProcessPool as error:
            left = list(places.values())
            pool.shutdown()  # how each process ended is known once the pool has waited for all
            killed = _killed(left, dict(workers), self._begun) or left[: self._processes]
            names = " or ".join(jobs[place].name for place in killed)
            raise JobKilledError("its process was killed, as happens when memory runs out", where=names) from error
        except BaseException:
            # Else what failed would be said when the jobs that run now are through, minutes later.
            pool.shutdown(wait=False, cancel_futures=True)
            for process in set(multiprocessing.active_children()) - self._others:
                process.terminate()
            raise


def _killed(left: Sequence[int], workers: Mapping[int, int], processes: Iterable[BaseProcess]) -> list[int]:
    """Places of the jobs whose processes did not end by the pool's own hand, which terminates the others."""
    ends = {process.pid: process.exitcode for process in processes}
    return [place for place in left if ends.get(workers.get(place)) not in (None, 0, -signal.SIGTERM)]


@contextmanager
def _named(job: StoredJob) -> Iterator[None]:
    """Add the name of the job to the notes of its errors."""
    try:
        yield
    except Exception as error:
        error.add_note(job.name)
        raise


def _run_in_worker(
    job: StoredJob, place: int, clocks: MutableMapping[int, float], workers: MutableMapping[int, int]
) -> None:
    workers[place] = os.getpid()
    # As on the command line: this process shares the machine with its siblings.
    freeze_survivors()
    with threadpool_limits(limits=1):
        job.run(_now_and_then(lambda done_s: clocks.__setitem__(place, done_s)))


def _now_and_then(tell: Progress) -> Progress:
    told_s = 0.0

    def tell_now_and_then(done_s: float) -> None:
        nonlocal told_s
        if done_s - told_s >= _TELL_EVERY_S:
            told_s = done_s
            tell(done_s)

    return tell_now_and_then


def _pool_progress(
    jobs: Sequence[StoredJob], left: Sequence[int], processes: int, clocks: MutableMapping[int, float]
) -> PoolProgress:
    """`left`: places of the jobs that are not through, in the order in which they are begun."""
    clock_s = dict(clocks)
    running = left[:processes]
    through_s = sum(job.robot_time_s for job in jobs) - sum(jobs[place].robot_time_s for place in left)
    running_s = sum(min(clock_s.get(place, 0.0), jobs[place].robot_time_s) for place in running)
    return PoolProgress(through_s + running_s, tuple(jobs[place].name for place in running))


def _belong_to_the_parent() -> None:
    """Leave Ctrl-C to the parent, and end with it however it ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    assert parent is not None
    sentinel = parent.sentinel

    def follow() -> None:
        connection.wait([sentinel])
        os._exit(ExitCode.FAILED)

    threading.Thread(target=follow, daemon=True, name="follow the parent").start()


Waves = Sequence[Sequence[StoredJob]]
"""Jobs of a study in waves, each of which needs only the waves before."""


def missing_time_s(waves: Waves, results: Results) -> float:
    """Return the robot time of all jobs without a result, in s.

    Raises StudyError if there are results of other settings, source or versions, or damaged files.
    """
    return sum(wave[place].robot_time_s for wave in waves for place in results.missing(wave))


def run_missing(
    waves: Waves, results: Results, executor: Executor, on_progress: Callable[[PoolProgress], None]
) -> None:
    """Run the jobs without a result, wave by wave; each stores its result as soon as it is done.

    `on_progress` gets the progress of all waves together. Raises StudyError if a process was killed, or results of
    other settings are in the folder, and any error of a job.
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
            do = "run again, it goes on where it was (with fewer --jobs it needs less)"
            raise StudyError(f"{error}", do=do) from error
        before_s += sum(job.robot_time_s for job in jobs)
        for job in wave:
            earlier[job.seed].append(job)
