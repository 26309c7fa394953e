"""The folder of results: goes on where it was, mixes nothing."""

import json
import re
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from kurt2rt.experiments.study.jobs import Progress, Results, StoredJob, StudyError, TaughtOutcome
from kurt2rt.experiments.study.provenance import Provenance
from tests.experiments.rows import MADE_OF, lesson

NOWHERE = Results(Path("never-made"))


@dataclass(frozen=True, kw_only=True)
class Job(StoredJob):
    outcome = TaughtOutcome
    results: Results = NOWHERE
    seed: int = 1
    made_of: Provenance = MADE_OF
    name: str = ""
    robot_time_s: float = 1.0

    def run(self, on_progress: Progress) -> None:
        raise NotImplementedError


class ReplacingJob(Job):
    replaces_others = True


def robot(seed: int) -> TaughtOutcome:
    return TaughtOutcome(made_of=MADE_OF, seed=seed, lesson=lesson(seed))


JOBS = [Job(stem=stem) for stem in ("shipped/one-1", "shipped/one-2", "plain/one-1")]


@pytest.mark.parametrize("what", list(Provenance.model_fields))
def test_results_of_another_make_are_refused_with_what_differs(what: str, tmp_path: Path) -> None:
    results = Results(tmp_path)
    results.write(JOBS[0], robot(1))
    results.write(JOBS[1], robot(2))
    other = [replace(job, made_of=MADE_OF.model_copy(update={what: "changed"})) for job in JOBS]
    with pytest.raises(StudyError, match=rf"one-1\.json .*\b1 .*: {what}\)") as caught:
        results.missing(other)
    assert caught.value.where == str(tmp_path)
    assert "--out" in caught.value.do


def test_missing_has_a_job_that_replaces_results_of_another_make(tmp_path: Path) -> None:
    results = Results(tmp_path)
    for job in JOBS[:2]:
        results.write(job, robot(1))
    other = MADE_OF.model_copy(update={"task": "changed"})
    assert results.missing([ReplacingJob(stem=JOBS[0].stem, made_of=other), JOBS[1]]) == [0]


def test_missing_raises_for_an_incomplete_result(tmp_path: Path) -> None:
    results = Results(tmp_path)
    results.write(JOBS[0], robot(1))
    content = json.loads((tmp_path / JOBS[0].file).read_text())
    del content["lesson"]["asks"]
    (tmp_path / JOBS[0].file).write_text(json.dumps(content))
    with pytest.raises(StudyError, match=r"one-1\.json: .*--out"):
        results.missing(JOBS)


def test_two_runs_do_not_write_into_one_folder(tmp_path: Path) -> None:
    with Results(tmp_path).held(), pytest.raises(StudyError, match=re.escape(f"{tmp_path}")), Results(tmp_path).held():
        pass
    with Results(tmp_path).held():
        pass


def test_held_removes_unfinished_folders(tmp_path: Path) -> None:
    results = Results(tmp_path / "new")
    with results.held(), results.scratch() as scratch:
        begun = scratch / "knowledge"
        begun.write_text("")
        results.keep(begun, "knowledge/shipped/one-1.knowledge")
    left_over = tmp_path / "new" / "unfinished-xyz"
    left_over.mkdir()
    (left_over / "knowledge").write_text("half")
    with results.held():
        assert not left_over.exists()
    assert [path.name for path in (tmp_path / "new").rglob("*") if path.is_file()] == [".lock", "one-1.knowledge"]
