"""Many jobs: in this process, and in others."""

import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest

from kurt2rt.experiments.study.jobs import Progress, Results, StoredJob
from kurt2rt.experiments.study.pool import JobKilledError, PoolProgress, open_processes
from kurt2rt.experiments.study.provenance import Provenance
from tests.experiments.rows import MADE_OF

RESULTS = Results(Path("never-made"))


@dataclass(frozen=True, kw_only=True)
class Job(StoredJob):
    results: Results = RESULTS
    seed: int = 1
    made_of: Provenance = MADE_OF
    stem: str = ""
    robot_time_s: float = 1.0
    fails: bool = False

    def run(self, tell: Progress) -> None:
        if self.fails:
            raise RuntimeError(f"{self.name} fails")
        tell(self.robot_time_s / 2)


JOBS = [Job(name=name, robot_time_s=time_s) for name, time_s in (("short", 10.0), ("long", 40.0), ("middle", 20.0))]


def run_jobs(jobs: Sequence[StoredJob], processes: int, told: list[PoolProgress] | None = None) -> None:
    with open_processes(processes) as running:
        running.run(jobs, {}, RESULTS, (told if told is not None else []).append)


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
        run_jobs([JOBS[0], JOBS[1], Job(name="middle", robot_time_s=20.0, fails=True)], 1, told)
    assert told[-1] == (40.0, ("middle",))
    assert caught.value.__notes__ == ["middle"]


@dataclass(frozen=True, kw_only=True)
class Asked(Job):
    """Writes down the process that it runs in."""

    folder: Path

    def run(self, tell: Progress) -> None:
        del tell
        (self.folder / f"{os.getpid()}").touch()


def test_a_single_job_of_a_wave_starts_no_process(tmp_path: Path) -> None:
    with open_processes(2) as processes:
        processes.run([Asked(name="alone", folder=tmp_path)], {}, RESULTS, lambda _: None)
    assert [path.name for path in tmp_path.iterdir()] == [str(os.getpid())]


@dataclass(frozen=True, kw_only=True)
class Killed(Job):
    """Kills its own process, as the system does where memory runs out."""

    name: str = "greedy, seed 7"

    def run(self, tell: Progress) -> None:
        del tell
        os.kill(os.getpid(), signal.SIGKILL)


@pytest.mark.deep
def test_a_job_whose_process_is_killed_is_named() -> None:
    jobs = [*JOBS, Killed()]
    with pytest.raises(JobKilledError, match=r"^greedy, seed 7: "):
        run_jobs(jobs, 2)


@dataclass(frozen=True, kw_only=True)
class Waiting(Job):
    """Says that it runs, then waits for what never comes."""

    begun: Path

    def run(self, tell: Progress) -> None:
        del tell
        self.begun.write_text(str(os.getpid()))
        os.write(1, b"begun\n")  # one write, so other writers cannot split it
        signal.pause()


_WAITS = """
import sys
from pathlib import Path
from tests.experiments.study.test_pool import Waiting, run_jobs

if __name__ == "__main__":
    folder = Path(sys.argv[1])
    run_jobs([Waiting(name=str(number), begun=folder / str(number)) for number in range(6)], 2)
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
