"""Executor of jobs on other machines: Dask workers run remote jobs, and only the executor's machine writes results."""

import logging
import os
import shlex
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple
from urllib.parse import urlsplit

from distributed import CancelledError, Client, Future, Security, Worker, as_completed
from distributed.scheduler import KilledWorker

from config.errors import UserError
from kurt2rt.experiments.lockstep.engine import choose_witnesses
from kurt2rt.experiments.study.jobs import Results, StoredJob
from kurt2rt.experiments.study.pool import JobKilledError, PoolProgress
from kurt2rt.experiments.study.remote_job import RemoteJob, WorkerDiffersError, pack, run_remote_job, unpack
from kurt2rt.platform.durable_files import fsync_folder

_MAKE = "kurt2rt study worker --new FILE --scheduler tls://HOST:PORT makes one"


class ClusterError(UserError):
    """Cluster that cannot be used: no such file, or no scheduler or worker that answers."""


class ClusterFile(NamedTuple):
    """Address and keys of a cluster, from the file by which its members know each other."""

    address: str
    """`tls://HOST:PORT` of the scheduler."""
    security: Security
    """Key and certificate; a connection without them is refused at both ends."""


def make_cluster_file(path: Path, address: str) -> None:
    """Make the file of a cluster, readable by its owner only, with a new key and certificate, valid for a year.

    `address`: of its scheduler, `tls://HOST:PORT`. Raises ClusterError for another address, OSError.
    """
    _require_tls(address, path)
    made = Security.temporary()
    with os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as file:
        # Readers of certificates pass over lines before the first block.
        file.write(f"{address}\n{made.tls_client_key}{made.tls_client_cert}")
        file.flush()
        os.fsync(file.fileno())
    fsync_folder(path.parent)


def read_cluster_file(path: Path) -> ClusterFile:
    """Return the content of a cluster's file.

    Raises ClusterError: it is none, or users other than its owner may read it and so run code on all members.
    """
    try:
        if path.stat().st_mode & 0o077:
            raise ClusterError("others may read it, and run programs by it", where=path, do=f"chmod 600 {path}")
        address = path.read_text().partition("\n")[0]
        names = [f"tls_{member}_{part}" for member in ("client", "worker", "scheduler") for part in ("cert", "key")]
        security = Security(require_encryption=True, tls_ca_file=str(path), **dict.fromkeys(names, str(path)))
        security.get_connection_args("client")
    except (OSError, ValueError) as error:
        raise ClusterError(f"is not a cluster file ({error})", where=path, do=_MAKE) from error
    _require_tls(address, path)
    return ClusterFile(address, security)


def scheduler_command(file: Path, address: str) -> str:
    """Return the command that starts the scheduler; started otherwise, Dask opens a port that runs any program."""
    there, certificate = urlsplit(address), str(file)
    return shlex.join(
        (
            *("dask", "scheduler", "--no-dashboard", "--protocol", "tls"),
            *("--host", str(there.hostname), "--port", str(there.port)),
            *("--tls-ca-file", certificate, "--tls-cert", certificate, "--tls-key", certificate),
        )
    )


def _no_scheduler(file: Path, address: str) -> ClusterError:
    do = f"start one there: {scheduler_command(file, address)}"
    return ClusterError("no scheduler of this cluster answers", where=address, do=do)


def _require_tls(address: str, where: Path) -> None:
    """Refuse any other address, because remote jobs are pickles: who may send one runs any program."""
    try:
        parts = urlsplit(address)
        is_tls = parts.scheme == "tls" and bool(parts.hostname) and parts.port is not None
    except ValueError:
        is_tls = False
    if not is_tls:
        raise ClusterError(f"no address of a scheduler (got {address}, allowed tls://HOST:PORT)", where=where, do=_MAKE)


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
        raise _no_scheduler(file, address) from error
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
        raise _no_scheduler(file, address) from error
