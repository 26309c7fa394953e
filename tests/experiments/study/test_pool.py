"""Many jobs: in this process, and in others."""

import gc
import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest

from kurt2rt.experiments.study import pool
from kurt2rt.experiments.study.pool import JobKilledError, JobProcesses, PoolProgress, Progress


@dataclass(frozen=True)
class Job:
    name: str
    robot_time_s: float
    fails: bool = False

    def run(self, tell: Progress) -> None:
        if self.fails:
            raise RuntimeError(f"{self.name} fails")
        tell(self.robot_time_s / 2)


JOBS = [Job("short", 10.0), Job("long", 40.0), Job("middle", 20.0)]


def run_jobs(jobs: Sequence[pool.Job], processes: int, told: list[PoolProgress] | None = None) -> None:
    with JobProcesses(processes) as running:
        running.run(jobs, (told if told is not None else []).append)


def test_run_jobs_progress_is_in_robot_time() -> None:
    told: list[PoolProgress] = []
    run_jobs(JOBS, 1, told)
    assert told == [
        (0.0, ("long",)),
        (20.0, ("long",)),
        (40.0, ("middle",)),
        (50.0, ("middle",)),
        (60.0, ("short",)),
        (65.0, ("short",)),
        (70.0, ()),
    ]


def test_run_jobs_error_ends_other_jobs() -> None:
    told: list[PoolProgress] = []
    with pytest.raises(RuntimeError, match="middle fails") as caught:
        run_jobs([JOBS[0], JOBS[1], Job("middle", 20.0, fails=True)], 1, told)
    assert told[-1] == (40.0, ("middle",))
    assert caught.value.__notes__ == ["middle"]


def test_run_jobs_unfreezes_only_what_it_froze() -> None:
    before = gc.get_freeze_count()
    assert before > 0  # tests/conftest.py
    run_jobs(JOBS, 1)
    assert gc.get_freeze_count() >= before


def test_no_jobs_are_no_work() -> None:
    told: list[PoolProgress] = []
    run_jobs([], 2, told)
    assert told == [(0.0, ())]


@pytest.mark.deep
def test_other_processes_tell_their_progress() -> None:
    told: list[PoolProgress] = []
    run_jobs(JOBS, 2, told)
    assert told[-1] == (70.0, ())


@dataclass(frozen=True)
class Asked:
    """Writes down the process that it runs in."""

    name: str
    folder: Path
    robot_time_s: float = 1.0

    def run(self, tell: Progress) -> None:
        del tell
        (self.folder / f"{os.getpid()}").touch()


@pytest.mark.deep
def test_processes_are_kept_from_wave_to_wave(tmp_path: Path) -> None:
    with JobProcesses(2) as processes:
        for _ in range(3):
            processes.run([Asked(str(number), tmp_path) for number in range(4)])
    used = {path.name for path in tmp_path.iterdir()}
    assert str(os.getpid()) not in used
    assert len(used) <= 2


def test_a_single_job_of_a_wave_starts_no_process(tmp_path: Path) -> None:
    with JobProcesses(2) as processes:
        processes.run([Asked("alone", tmp_path)])
    assert [path.name for path in tmp_path.iterdir()] == [str(os.getpid())]


@pytest.mark.deep
def test_run_jobs_error_in_a_process_names_the_job() -> None:
    with pytest.raises(RuntimeError, match="middle fails") as caught:
        run_jobs([JOBS[0], Job("middle", 20.0, fails=True)], 2)
    assert caught.value.__notes__ == ["middle"]


@dataclass(frozen=True)
class Killed:
    """Kills its own process, as the system does where memory runs out."""

    name: str = "greedy, seed 7"
    robot_time_s: float = 30.0

    def run(self, tell: Progress) -> None:
        del tell
        os.kill(os.getpid(), signal.SIGKILL)


@pytest.mark.deep
def test_a_job_whose_process_is_killed_is_named() -> None:
    jobs: list[Job | Killed] = [*JOBS, Killed()]
    with pytest.raises(JobKilledError, match=r"^greedy, seed 7: "):
        run_jobs(jobs, 2)


@dataclass(frozen=True)
class Waiting:
    """Says that it runs, then waits for what never comes."""

    name: str
    file: Path
    robot_time_s: float = 1.0

    def run(self, tell: Progress) -> None:
        del tell
        self.file.write_text(str(os.getpid()))
        os.write(1, b"begun\n")  # one write, so other writers cannot split it
        signal.pause()


_WAITS = """
import sys
from pathlib import Path
from tests.experiments.study.test_pool import Waiting, run_jobs

if __name__ == "__main__":
    folder = Path(sys.argv[1])
    run_jobs([Waiting(str(number), folder / str(number)) for number in range(6)], 2)
"""


@pytest.mark.deep
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL], ids=["Ctrl-C", "killed"])
def test_no_job_outlives_its_parent(number: signal.Signals, tmp_path: Path) -> None:
    script = tmp_path / "waits.py"
    script.write_text(_WAITS)
    root = Path(__file__).parents[3]
    begun = tmp_path / "begun"
    begun.mkdir()
    with subprocess.Popen(
        [sys.executable, script, begun],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, "PYTHONPATH": str(root)},
        start_new_session=True,
        text=True,
    ) as parent:
        assert parent.stdout is not None
        try:
            assert [parent.stdout.readline() for _ in range(2)] == ["begun\n"] * 2
        except BaseException:
            parent.kill()
            raise
        parent.send_signal(number)
        # The end of file comes when the last of them is gone, who all hold the other end.
        assert parent.stdout.read() == ""
        said = parent.communicate()[1]
    assert len(list(begun.iterdir())) == 2
    if number is signal.SIGINT:
        assert said.rstrip().endswith("KeyboardInterrupt")
