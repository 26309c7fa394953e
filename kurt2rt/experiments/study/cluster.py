"""Executor of jobs on other machines: Dask workers run remote jobs, and only the executor's machine writes results."""

import logging
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from distributed import CancelledError, Client, Future, Worker, as_completed
from distributed.scheduler import KilledWorker

from kurt2rt.experiments.lockstep.engine import choose_witnesses
from kurt2rt.experiments.study.cluster_file import ClusterError, no_scheduler, read_cluster_file
from kurt2rt.experiments.study.pool import JobKilledError, PoolProgress
from kurt2rt.experiments.study.remote_job import RemoteJob, WorkerDiffersError, pack, run_remote_job, unpack
from kurt2rt.experiments.study.results import Results, StoredJob

_AHEAD = 2
"""Remote jobs on their way for each worker, so that none waits for its next one."""
_TIMEOUT_S = 10.0
_LOOK_EVERY_S = 0.2


@contextmanager
def open_cluster(file: Path) -> Iterator["ClusterExecutor"]:
    """Yield an executor on the workers of a scheduler; `file`: of the cluster.

    Raises ClusterError if that is no file of a cluster, or no scheduler with its certificate answers.
    """
    for name in ("distributed", "distributed.client"):  # Dask sets a level of both; errors are raised as well
        logging.getLogger(name).setLevel(logging.CRITICAL)
    address, security = read_cluster_file(file)
    try:
        client = Client(address, timeout=_TIMEOUT_S, security=security)
    except (OSError, TimeoutError) as error:
        raise no_scheduler(file, address) from error
    with client:
        yield ClusterExecutor(client)


class ClusterExecutor:
    """Executor of a study's jobs on the workers of a Dask scheduler, one job each at a time.

    1 % of the jobs run on two workers and must agree.
    """

    def __init__(self, client: Client) -> None:
        self._client = client

    def run(
        self,
        jobs: Sequence[StoredJob],
        earlier: Mapping[int, Sequence[StoredJob]],
        results: Results,
        on_progress: Callable[[PoolProgress], None],
    ) -> None:
        """Run all jobs (`Executor.run`); a job whose worker was killed runs on another one.

        Raises ClusterError if there is no worker, or the scheduler is gone; JobKilledError if the workers of a job were
        killed again and again; WorkerDiffersError if a worker has another program, or two came to different results.
        """
        waiting = sorted(jobs, key=lambda job: -job.robot_time_s)
        witnessed = set(choose_witnesses([job.file for job in jobs], "jobs on two workers", least=1))
        running: dict[Future, StoredJob] = {}
        done_s = 0.0
        finished = as_completed()

        def submit() -> None:
            job = waiting.pop(0)
            remote_job = pack(job, results, earlier.get(job.seed, ()))
            future = self._client.submit(run_remote_job, remote_job, pure=False, key=f"{job.name}-{id(remote_job)}")
            running[future] = job
            finished.add(future)

        try:
            for _ in range(min(len(waiting), _AHEAD * self._workers())):
                submit()
            for future in finished:
                job = running.pop(future)
                files = _files_of(future, job)
                if job.file in witnessed:
                    remote_job = pack(job, results, earlier.get(job.seed, ()))
                    require_witness(self._client, future, job, remote_job, files)
                unpack(job, results, files)
                future.release()  # else it is computed again if its worker dies
                done_s += job.robot_time_s
                if waiting:
                    submit()
                on_progress(PoolProgress(done_s, tuple(each.name for each in running.values())))
        finally:
            self._client.cancel(list(running))

    def _workers(self) -> int:
        try:
            self._client.wait_for_workers(1, timeout=_TIMEOUT_S)
            return len(self._client.scheduler_info()["workers"])
        except (TimeoutError, OSError) as error:
            raise ClusterError(
                "the cluster has no worker",
                where=self._client.scheduler.address,
                do="start one or more: kurt2rt study worker --cluster FILE",
            ) from error


def require_witness(
    client: Client, future: Future, job: StoredJob, remote_job: RemoteJob, files: Mapping[str, bytes]
) -> None:
    """Run a job on another worker too, if there is one, and compare the results.

    `future`: finished future of the job; not released. `files`: files that the job gave. Raises WorkerDiffersError if
    the results differ, and any error of the job.
    """
    own = {each for places in client.who_has([future]).values() for each in places}
    others = sorted(set(client.scheduler_info()["workers"]) - own)
    if not own or not others:
        return
    again = client.submit(run_remote_job, remote_job, pure=False, key=f"{job.name}-again", workers=others)
    while not again.done():
        time.sleep(_LOOK_EVERY_S)
        if not set(others) & set(client.scheduler_info()["workers"]):
            return  # all other workers were killed, and the job would wait for them
    if _files_of(again, job)[job.file] != files[job.file]:
        raise WorkerDiffersError(
            f"{' and '.join(sorted(own))} and one of {', '.join(others)} came to different results",
            where=job.name,
            do="do it on a third machine, and leave the wrong one out",
        )


def _files_of(future: Future, job: StoredJob) -> dict[str, bytes]:
    """Return the files that a job gave; its errors are noted with its name. Raises JobKilledError, ClusterError."""
    try:
        files: dict[str, bytes] = future.result()
    except KilledWorker as error:
        raise JobKilledError("its workers were killed, as happens when memory runs out", where=job.name) from error
    except CancelledError as error:
        raise ClusterError("the scheduler is gone", do="start it and run again, it goes on where it was") from error
    except Exception as error:
        error.add_note(job.name)
        raise
    return files


async def serve(file: Path, on_ready: Callable[[str], None]) -> None:
    """Be a worker: run jobs, one at a time in this process, until the scheduler is gone; `on_ready` gets the address.

    Raises ClusterError if `file` is no file of a cluster, or no scheduler with its certificate answers.
    """
    address, security = read_cluster_file(file)
    logging.getLogger("distributed").setLevel(logging.WARNING)
    try:
        async with Worker(
            address, nthreads=1, protocol="tls", security=security, death_timeout=_TIMEOUT_S, dashboard=False
        ) as worker:
            worker.http_server.stop()  # Dask's pages about a worker, which any program could read
            on_ready(worker.address)
            try:
                await worker.finished()
            finally:  # closing breaks off a heartbeat, which Dask logs as an error with a traceback
                logging.getLogger("distributed.worker").setLevel(logging.CRITICAL)
    except (OSError, TimeoutError) as error:
        raise no_scheduler(file, address) from error
