"""Many jobs in parallel processes."""

import gc
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, MutableMapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import connection
from multiprocessing.managers import SyncManager
from multiprocessing.process import BaseProcess
from typing import NamedTuple, Protocol, Self, TypeVar

from threadpoolctl import threadpool_limits

from hal.errors import ExitCode, UserError
from kurt2rt.platform.gc_control import freeze_survivors

Progress = Callable[[float], None]
"""Takes how far a job is, in seconds of robot time."""

ResultT = TypeVar("ResultT")
ResultT_co = TypeVar("ResultT_co", covariant=True)

_LOOK_EVERY_S = 0.5
_TELL_EVERY_S = 5.0


class JobKilledError(UserError):
    """The process of a job was killed from outside; the message names the job."""


class Job(Protocol[ResultT_co]):
    """Job that can be sent to another process."""

    @property
    def name(self) -> str:
        """Name in progress displays."""
        ...

    @property
    def robot_time_s(self) -> float:
        """Simulated time of the whole job in s, for the progress."""
        ...

    def run(self, tell: Progress) -> ResultT_co:
        """Run the job and return its result; `tell` gets the simulated seconds so far."""
        ...


class PoolProgress(NamedTuple):
    """Progress of all jobs of a pool."""

    done_s: float
    """Robot time so far, in s."""
    running: tuple[str, ...]
    """Names of the running jobs."""


def run_jobs(
    jobs: Sequence[Job[ResultT]],
    processes: int,
    *,
    on_done: Callable[[int], None] = lambda _: None,
    on_progress: Callable[[PoolProgress], None] = lambda _: None,
) -> list[ResultT]:
    """Run all jobs, the longest first; return their results in the order of the jobs.

    With one process it is this one. The first error of a job ends all other jobs, and so does Ctrl-C; the error's notes
    name the job.

    Args:
        on_done: gets the index of each job that is through.
        on_progress: gets the progress of all jobs twice a second.

    Raises:
        JobKilledError: a process was killed from outside.
        Exception: any error of a job.
    """
    with JobProcesses(min(processes, max(1, len(jobs)))) as pool:
        return pool.run(jobs, on_done, on_progress)


def _run_here(
    jobs: Sequence[Job[ResultT]],
    order: Sequence[int],
    on_done: Callable[[int], None],
    on_progress: Callable[[PoolProgress], None],
) -> list[ResultT]:
    results: dict[int, ResultT] = {}
    before_s = 0.0
    frozen_before = gc.get_freeze_count()
    try:
        for place in order:
            job = jobs[place]
            on_progress(PoolProgress(before_s, (job.name,)))

            def tell(done_s: float, job: Job[ResultT] = job, before_s: float = before_s) -> None:
                on_progress(PoolProgress(before_s + done_s, (job.name,)))

            freeze_survivors()
            with threadpool_limits(limits=1), _named(job):
                results[place] = job.run(_now_and_then(tell))
            before_s += job.robot_time_s
            on_done(place)
    finally:
        if frozen_before == 0:  # a caller keeps its frozen objects
            gc.unfreeze()
    on_progress(PoolProgress(before_s, ()))
    return [results[place] for place in range(len(jobs))]


class JobProcesses:
    """Processes that run the jobs of several waves; a context that ends them.

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

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._pool is not None:
            self._pool.shutdown()
        if self._manager is not None:
            self._manager.shutdown()

    def run(
        self,
        jobs: Sequence[Job[ResultT]],
        on_done: Callable[[int], None] = lambda _: None,
        on_progress: Callable[[PoolProgress], None] = lambda _: None,
    ) -> list[ResultT]:
        """Run all jobs as `run_jobs` does; after an error no others can be run."""
        # The longest last would leave the other processes idle at the end.
        order = sorted(range(len(jobs)), key=lambda place: -jobs[place].robot_time_s)
        if self._processes == 1 or len(jobs) <= 1:
            return _run_here(jobs, order, on_done, on_progress)
        return self._run_apart(jobs, order, on_done, on_progress)

    def _started(self) -> tuple[ProcessPoolExecutor, SyncManager]:
        if self._pool is None or self._manager is None:
            self._manager = SyncManager(ctx=self._context)
            self._manager.start(_belong_to_the_parent)
            self._others = set(multiprocessing.active_children())
            self._pool = ProcessPoolExecutor(
                self._processes, mp_context=self._context, initializer=_belong_to_the_parent
            )
        return self._pool, self._manager

    def _run_apart(
        self,
        jobs: Sequence[Job[ResultT]],
        order: Sequence[int],
        on_done: Callable[[int], None],
        on_progress: Callable[[PoolProgress], None],
    ) -> list[ResultT]:
        pool, manager = self._started()
        results: dict[int, ResultT] = {}
        clocks, workers = manager.dict(), manager.dict()
        places: dict[Future[ResultT], int] = {}
        try:
            for place in order:
                places[pool.submit(_run_in_worker, jobs[place], place, clocks, workers)] = place
                self._begun.update(set(multiprocessing.active_children()) - self._others)
            waiting = set(places)
            while waiting:
                done, waiting = wait(waiting, timeout=_LOOK_EVERY_S, return_when=FIRST_COMPLETED)
                for future in done:
                    with _named(jobs[places[future]]):
                        results[places[future]] = future.result()
                    on_done(places[future])
                left = [place for place in order if place not in results]
                on_progress(_pool_progress(jobs, left, self._processes, clocks))
        except BrokenProcessPool as error:
            left = [place for place in order if place not in results]
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
        return [results[place] for place in range(len(jobs))]


def _killed(left: Sequence[int], workers: Mapping[int, int], processes: Iterable[BaseProcess]) -> list[int]:
    """Places of the jobs whose processes did not end by the pool's own hand, which terminates the others."""
    ends = {process.pid: process.exitcode for process in processes}
    return [place for place in left if ends.get(workers.get(place)) not in (None, 0, -signal.SIGTERM)]


@contextmanager
def _named(job: Job[object]) -> Iterator[None]:
    """Add the name of the job to the notes of its errors."""
    try:
        yield
    except Exception as error:
        error.add_note(job.name)
        raise


def _run_in_worker(
    job: Job[ResultT], place: int, clocks: MutableMapping[int, float], workers: MutableMapping[int, int]
) -> ResultT:
    workers[place] = os.getpid()
    # As on the command line: this process shares the machine with its siblings.
    freeze_survivors()
    with threadpool_limits(limits=1):
        return job.run(_now_and_then(lambda done_s: clocks.__setitem__(place, done_s)))


def _now_and_then(tell: Progress) -> Progress:
    told_s = 0.0

    def tell_now_and_then(done_s: float) -> None:
        nonlocal told_s
        if done_s - told_s >= _TELL_EVERY_S:
            told_s = done_s
            tell(done_s)

    return tell_now_and_then


def _pool_progress(
    jobs: Sequence[Job[ResultT]], left: Sequence[int], processes: int, clocks: MutableMapping[int, float]
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
