"""Remote jobs: a job runs in another folder, with the files that it needs, and gives the same files."""

import pickle
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from kurt2rt.experiments.study.jobs import Progress, Results, StoredJob, TaughtOutcome
from kurt2rt.experiments.study.pool import PoolProgress, run_missing
from kurt2rt.experiments.study.provenance import Provenance
from kurt2rt.experiments.study.remote_job import WorkerDiffersError, pack, run_remote_job, unpack
from tests.experiments.rows import MADE_OF, lesson
from tests.experiments.study.here import HERE


@dataclass(frozen=True, kw_only=True)
class Job(StoredJob):
    """Writes as many RLAs as the files that it reads are long."""

    outcome = TaughtOutcome
    before: "Job | None" = None
    given: Path | None = None
    made_of: Provenance = MADE_OF
    robot_time_s: float = 1.0

    def run(self, tell: Progress) -> None:
        tell(1.0)
        length = 7 if self.given is None else len(self.given.read_text())
        if self.before is not None:
            length += self.before.results.read(self.before, TaughtOutcome).lesson.rlas
            length += len(self.before.knowledge.read_text())
        with self.results.scratch() as folder:
            (folder / "knowledge").write_text(f"{self.name} taught")
            self.results.keep(folder / "knowledge", f"knowledge/{self.stem}.knowledge")
        outcome = TaughtOutcome(made_of=MADE_OF, seed=self.seed, lesson=lesson(self.seed, rlas=length))
        self.results.write(self, outcome)


def job_in(results: Results, seed: int, stem: str, **more: Any) -> Job:
    return Job(results=results, seed=seed, stem=f"{stem}-{seed}", name=f"{stem}, seed {seed}", **more)


def waves_in(folder: Path, given: Path) -> Sequence[Sequence[Job]]:
    results = Results(folder)
    first = [job_in(results, seed, "first", given=given) for seed in (3, 5)]
    return first, [job_in(results, job.seed, "then", before=job) for job in first]


@pytest.fixture
def given(tmp_path: Path) -> Path:
    path = tmp_path / "given.txt"
    path.write_text("0123456789")
    return path


def files(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_remote_jobs_give_what_jobs_leave_here(tmp_path: Path, given: Path) -> None:
    plans = [waves_in(tmp_path / name, given) for name in ("here", "there")]
    here, there = Results(tmp_path / "here"), Results(tmp_path / "there")
    with here.held(), there.held():
        run_missing(plans[0], here, HERE, lambda _: None)
        done: list[Job] = []
        for wave in plans[1]:
            for job in wave:
                remote_job = pack(job, there, [each for each in done if each.seed == job.seed])
                before = files(tmp_path / "there")
                given_files = run_remote_job(pickle.loads(pickle.dumps(remote_job)))
                assert files(tmp_path / "there") == before  # only the sender writes its folder
                unpack(job, there, given_files)
            done += wave
    assert files(tmp_path / "there") == files(tmp_path / "here")


def test_remote_job_of_another_program_is_refused(tmp_path: Path, given: Path) -> None:
    (first, _), _ = waves_in(tmp_path, given)
    remote_job = pack(first, Results(tmp_path), [])._replace(program="another")
    with pytest.raises(WorkerDiffersError, match=r"got [0-9a-f]{16}, Python .+, allowed another"):
        run_remote_job(remote_job)


def test_unpack_gives_an_earlier_knowledge_file_another_name(tmp_path: Path, given: Path) -> None:
    results = Results(tmp_path / "there")
    (first, _), _ = waves_in(tmp_path / "there", given)
    name = str(first.knowledge_name)
    with results.held():
        unpack(first, results, {name: b"old", first.file: b"{}"})
        unpack(first, results, {name: b"new", first.file: b"{}"})
    knowledge = first.knowledge
    assert (knowledge.read_bytes(), knowledge.with_name(f"{knowledge.name}.1").read_bytes()) == (b"new", b"old")


def test_executor_gets_the_earlier_jobs_of_each_robot(tmp_path: Path, given: Path) -> None:
    plan, results = waves_in(tmp_path / "there", given), Results(tmp_path / "there")
    executor = _InTurn()
    with results.held():
        run_missing(plan, results, executor, lambda _: None)
        assert executor.earlier == [{}, {3: ["first, seed 3"], 5: ["first, seed 5"]}]
        (tmp_path / "there" / plan[1][1].file).unlink()
        run_missing(plan, results, executor, lambda _: None)
    assert results.missing(plan[1]) == []


class _InTurn:
    """Executor that run remote jobs in this process."""

    def __init__(self) -> None:
        self.earlier: list[dict[int, list[str]]] = []

    def run(
        self,
        jobs: Sequence[StoredJob],
        earlier: Mapping[int, Sequence[StoredJob]],
        results: Results,
        on_progress: Callable[[PoolProgress], None],
    ) -> None:
        self.earlier.append({seed: [each.name for each in done] for seed, done in earlier.items()})
        for job in jobs:
            unpack(job, results, run_remote_job(pack(job, results, earlier.get(job.seed, ()))))
            on_progress(PoolProgress(1.0, ()))
