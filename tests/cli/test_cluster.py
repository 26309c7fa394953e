"""Studies on two workers of a scheduler, on loopback."""

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

from kurt2rt.experiments.study.cluster import ClusterError, require_safe, require_witness
from kurt2rt.experiments.study.parcel import Parcel, WorkerDiffersError
from kurt2rt.experiments.study.results import Results
from tests.cli.helpers import ROOT, CommandLine
from tests.experiments.study.test_parcel import Job

ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONUNBUFFERED": "1"}
LESSON = (
    *("lesson", "--task", "circle", "--seeds", "3-8", "--set", "teaching.supervised_s=5"),
    *("--set", "teaching.corrections_s=5", "--set", "exam.duration_s=10"),
)


@pytest.mark.parametrize(
    "address", ["tls://lab:8786", "tls://10.0.0.7:8786", "tcp://127.0.0.1:8786", "tcp://localhost:1", "tcp://[::1]:2"]
)
def test_address_of_tls_or_loopback_is_taken(address: str) -> None:
    require_safe(address)


@pytest.mark.parametrize(
    "address",
    [
        "tcp://lab:8786",
        "tcp://10.0.0.7:8786",
        "lab:8786",
        "8786",
        "",
        "tcp://127.0.0.1",
        "ws://127.0.0.1:80",
        "tls://x:y",
    ],
)
def test_address_that_others_could_write_to_is_refused(address: str) -> None:
    with pytest.raises(ClusterError, match=r"got .*, allowed tls://HOST:PORT"):
        require_safe(address)


def test_unsafe_address_is_refused_before_any_job(kurt2rt: CommandLine) -> None:
    assert "allowed tls://HOST:PORT" in kurt2rt.refused(*LESSON, "--on", "tcp://lab:8786", "--out", "made")
    assert not Path("made").exists()
    assert "allowed tls://HOST:PORT" in kurt2rt.refused("worker", "--to", "tcp://lab:8786")


@pytest.mark.parametrize("words", [("paper", "--on", "local", "--task", "circle"), ("worker", "--to", "tls://x:1")])
def test_cluster_without_dask_names_its_extra(
    kurt2rt: CommandLine, monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...]
) -> None:
    for name in [name for name in sys.modules if name.startswith("kurt2rt.experiments.study.cluster")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert "pip install 'kurt2rt[cluster]'" in kurt2rt.refused(*words)


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
        return {"job": ["tcp://127.0.0.1:1"]}

    def scheduler_info(self) -> dict[str, dict[str, object]]:
        return {"workers": dict.fromkeys(self._workers)}

    def submit(self, *_: object, workers: list[str], **__: object) -> OneFuture:
        assert workers == ["tcp://127.0.0.1:2"]
        return OneFuture({JOB.file: self._result})


JOB = Job(results=Results(Path("made")), seed=3, stem="one")
OWN, OTHER = "tcp://127.0.0.1:1", "tcp://127.0.0.1:2"


def witness(result: bytes, *workers: str) -> None:
    parcel = Parcel(b"", "made", {}, {}, "program")
    require_witness(TwoWorkers(result, *workers), OneFuture({}), JOB, parcel, {JOB.file: b"right"})


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
        scheduler = (sys.executable, "-m", "dask", "scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard")
        self.scheduler, line = stack.enter_context(started(*scheduler, folder=folder, until="Scheduler at:"))
        (self.address,) = re.findall(r"tcp://\S+", line)
        self.workers = [self.start_worker(), self.start_worker()]

    def start_worker(self) -> "subprocess.Popen[str]":
        words = (sys.executable, "-m", "kurt2rt.cli.main", "worker", "--to", self.address)
        return self._stack.enter_context(started(*words, folder=self._folder, until="worker  tcp://"))[0]

    def lesson(self, out: str) -> "subprocess.Popen[str]":
        words = (sys.executable, "-m", "kurt2rt.cli.main", *LESSON, "--on", self.address, "--out", out)
        return subprocess.Popen(
            words,
            cwd=self._folder,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=ENVIRONMENT,
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
