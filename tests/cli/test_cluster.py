"""Studies on two workers of a scheduler, on loopback."""

import asyncio
import os
import shlex
import signal
import socket
import ssl
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import psutil
import pytest
from distributed import Scheduler, Security
from distributed.comm import CommClosedError, connect

from kurt2rt.cli.study_run import open_executor
from kurt2rt.experiments.study.cluster import (
    ClusterError,
    make_cluster_file,
    read_cluster_file,
    require_witness,
    scheduler_command,
    serve,
)
from kurt2rt.experiments.study.jobs import Results
from kurt2rt.experiments.study.remote_job import RemoteJob, WorkerDiffersError
from tests.cli.helpers import ROOT, CommandLine
from tests.experiments.study.test_remote_job import Job

ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONUNBUFFERED": "1"}
ENVIRONMENT.pop("COLUMNS", None)  # many workers of pytest have one
LESSON = (
    *("train", "--task", "circle", "--seeds", "3-8", "--set", "teaching.supervised_s=5"),
    *("--set", "teaching.corrections_s=5", "--set", "exam.duration_s=10"),
)


@pytest.fixture
def cluster(tmp_path: Path) -> Path:
    """Make the file of a cluster on this machine."""
    make_cluster_file(tmp_path / "lab.cluster", "tls://127.0.0.1:1")
    return tmp_path / "lab.cluster"


def put_address(cluster: Path, address: str) -> None:
    """Put another address into the file of a cluster."""
    cluster.write_text(address + cluster.read_text().removeprefix("tls://127.0.0.1:1"))


@pytest.mark.parametrize("address", ["tcp://lab:8786", "tcp://[::1]:2", "lab:8786", "", "tls://lab", "tls://x:y"])
def test_cluster_file_of_an_address_without_tls_is_refused(cluster: Path, address: str) -> None:
    with pytest.raises(ClusterError, match=r"got .*, allowed tls://HOST:PORT"):
        make_cluster_file(cluster.with_name("other"), address)
    put_address(cluster, address)
    with pytest.raises(ClusterError, match=r"got .*, allowed tls://HOST:PORT"):
        read_cluster_file(cluster)


def test_study_and_worker_without_a_cluster_file_are_refused(kurt2rt: CommandLine, cluster: Path) -> None:
    Path("other").write_text("tls://lab:8786\n")
    Path("other").chmod(0o600)
    with pytest.raises(ClusterError, match="local: is not a cluster file"), open_executor(Path("local"), 1):
        pytest.fail("a study began")
    assert "other: is not a cluster file" in kurt2rt.refused("study", "worker", "--cluster", "other")
    cluster.chmod(0o640)
    assert f"others may read it, and run programs by it; chmod 600 {cluster}" in kurt2rt.refused(
        "study", "worker", "--cluster", cluster
    )


def test_worker_new_makes_a_private_file_and_overwrites_none(kurt2rt: CommandLine, tmp_path: Path) -> None:
    made = kurt2rt("study", "worker", "--new", "lab.cluster", "--scheduler", "tls://lab:8786")
    assert made.out.splitlines()[1] == (
        "scheduler  dask scheduler --no-dashboard --protocol tls --host lab --port 8786 "
        "--tls-ca-file lab.cluster --tls-cert lab.cluster --tls-key lab.cluster"
    )
    assert (tmp_path / "lab.cluster").stat().st_mode & 0o777 == 0o600
    assert read_cluster_file(tmp_path / "lab.cluster").address == "tls://lab:8786"
    assert "File exists" in kurt2rt.refused("study", "worker", "--new", "lab.cluster", "--scheduler", "tls://lab:8786")


async def test_program_without_the_cluster_file_reaches_no_port(cluster: Path) -> None:
    _, security = read_cluster_file(cluster)
    ready: asyncio.Future[str] = asyncio.Future()
    async with Scheduler(
        protocol="tls", host="127.0.0.1", port=0, security=security, dashboard=False, dashboard_address=":0"
    ) as scheduler:
        put_address(cluster, scheduler.address)
        before = listening()
        serving = asyncio.create_task(serve(cluster, ready.set_result))
        worker = await ready
        try:
            assert listening() - before == {int(worker.rpartition(":")[2])}
            for address in (scheduler.address, worker):
                await (await connect(address, **security.get_connection_args("client"))).close()
                for context in (trusts_all(), trusts_all(Security.temporary()), None):
                    place = address if context is not None else address.replace("tls", "tcp")
                    with pytest.raises(CommClosedError):
                        await connect(place, timeout=5, ssl_context=context)
        finally:
            serving.cancel()
            await asyncio.wait([serving])


def trusts_all(security: Security | None = None) -> ssl.SSLContext:
    """Return the context of a program that takes any certificate of the other end, and has one of its own or none."""
    if security is None:
        context = ssl.create_default_context()
    else:
        context = security.get_connection_args("client")["ssl_context"]
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    return context


def listening() -> set[int]:
    """Return the TCP ports on which this process listens."""
    ports = psutil.Process().net_connections("tcp")
    return {each.laddr.port for each in ports if each.status == psutil.CONN_LISTEN}


@pytest.mark.parametrize(
    "words", [("study", "paper", "--cluster", "x", "--task", "circle"), ("study", "worker", "--cluster", "x")]
)
def test_cluster_without_dask_names_its_extra(
    kurt2rt: CommandLine, monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...]
) -> None:
    for name in [name for name in sys.modules if name.startswith("kurt2rt.experiments.study.cluster")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert "pip install '.[studies]' in kurt2rt's folder" in kurt2rt.refused(*words)


class OneFuture:
    """Future of a job that gave these files."""

    def __init__(self, files: dict[str, bytes]) -> None:
        self._files = files

    def done(self) -> bool:
        return True

    def result(self) -> dict[str, bytes]:
        return self._files


class TwoWorkers:
    """Client of a cluster, whose second worker comes to this result."""

    def __init__(self, result: bytes, *workers: str) -> None:
        self._result, self._workers = result, workers

    def who_has(self, _futures: object) -> dict[str, list[str]]:
        return {"job": ["tls://127.0.0.1:1"]}

    def scheduler_info(self) -> dict[str, dict[str, object]]:
        return {"workers": dict.fromkeys(self._workers)}

    def submit(self, *_: object, workers: list[str], **__: object) -> OneFuture:
        assert workers == ["tls://127.0.0.1:2"]
        return OneFuture({JOB.file: self._result})


JOB = Job(results=Results(Path("made")), seed=3, stem="one-3", name="one, seed 3")
OWN, OTHER = "tls://127.0.0.1:1", "tls://127.0.0.1:2"


def witness(result: bytes, *workers: str) -> None:
    remote_job = RemoteJob(b"", "made", {}, {}, "program")
    require_witness(TwoWorkers(result, *workers), OneFuture({}), JOB, remote_job, {JOB.file: b"right"})


def test_workers_that_differ_in_one_bit_are_refused_by_name() -> None:
    with pytest.raises(WorkerDiffersError, match=rf"^one, seed 3: {OWN} and one of {OTHER} came to different results"):
        witness(b"wrong", OWN, OTHER)


def test_equal_results_and_a_lone_worker_are_accepted() -> None:
    witness(b"right", OWN, OTHER)
    witness(b"never asked", OWN)


@contextmanager
def started(*words: str, folder: Path, until: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """Start a program; yield it, and the line that holds a text."""
    process = subprocess.Popen(
        words, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=ENVIRONMENT
    )
    try:
        assert process.stdout is not None
        yield process, next(line for line in process.stdout if until in line)
    finally:
        process.kill()
        process.communicate()


class Cluster:
    """A scheduler with two workers."""

    def __init__(self, folder: Path, stack: ExitStack) -> None:
        self._folder, self._stack = folder, stack
        with socket.create_server(("127.0.0.1", 0)) as free:
            address = f"tls://127.0.0.1:{free.getsockname()[1]}"
        self.file = folder / "lab.cluster"
        make_cluster_file(self.file, address)
        words = (sys.executable, "-m", *shlex.split(scheduler_command(self.file, address)))
        self.scheduler, _ = stack.enter_context(started(*words, folder=folder, until="Scheduler at:"))
        self.workers = [self.start_worker(), self.start_worker()]

    def start_worker(self) -> "subprocess.Popen[str]":
        words = (sys.executable, "-m", "kurt2rt.cli.main", "study", "worker", "--cluster", str(self.file))
        return self._stack.enter_context(started(*words, folder=self._folder, until="worker  tls://"))[0]

    def lesson(self, out: str) -> "subprocess.Popen[str]":
        words = (sys.executable, "-m", "kurt2rt.cli.main", *LESSON, "--cluster", str(self.file), "--out", out)
        return subprocess.Popen(
            words, cwd=self._folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT
        )


def results_of(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in (folder / "results").glob("*.json")}


def wait_for_result(folder: Path, program: "subprocess.Popen[str]") -> None:
    while program.poll() is None and not results_of(folder):
        time.sleep(0.05)


@pytest.mark.deep
def test_cluster_gives_what_this_machine_does(kurt2rt: CommandLine, tmp_path: Path) -> None:
    alone = kurt2rt(*LESSON, "--jobs", "1", "--out", "alone")
    assert alone.exit_code == 0, alone.err
    with ExitStack() as stack:
        cluster = Cluster(tmp_path, stack)
        with cluster.lesson("killed") as lesson:  # a worker is killed, another one takes its job
            wait_for_result(tmp_path / "killed", lesson)
            cluster.workers[0].send_signal(signal.SIGKILL)
            out, err = lesson.communicate()
        assert lesson.returncode == 0, err
        assert out == alone.out
        assert results_of(tmp_path / "killed") == results_of(tmp_path / "alone")

        with cluster.lesson("lost") as lesson:  # the scheduler is killed, and the study goes on without it
            wait_for_result(tmp_path / "lost", lesson)
            cluster.scheduler.send_signal(signal.SIGKILL)
            err = lesson.communicate()[1]
        assert lesson.returncode == 2
        assert err.splitlines()[-1].startswith("kurt2rt: the scheduler is gone; ")
    begun = len(results_of(tmp_path / "lost"))
    assert 0 < begun < 6
    rest = kurt2rt(*LESSON, "--jobs", "1", "--out", "lost")
    assert (rest.exit_code, rest.out) == (0, alone.out)
    assert results_of(tmp_path / "lost") == results_of(tmp_path / "alone")
    assert not list((tmp_path / "lost").glob("unfinished-*"))
