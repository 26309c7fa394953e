"""Witnesses of jobs in the batch."""

from pathlib import Path

import pytest

from kurt2rt.experiments.lockstep import curriculum
from kurt2rt.experiments.lockstep.batch_exam import examine_in_batch
from kurt2rt.experiments.lockstep.batch_lesson import teach_in_batch
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.lockstep.engine import BatchDiffersError
from kurt2rt.experiments.lockstep.lesson import GivenLesson
from kurt2rt.experiments.study.jobs import Results, StudyError
from kurt2rt.experiments.study.provenance import source_hash
from kurt2rt.experiments.study.seeds import make_plan, read_results
from kurt2rt.experiments.study.study_plan import (
    BusWitnessJob,
    BusWitnessOutcome,
    EngineRequest,
    StudyPlan,
    require_no_difference,
)
from tests.experiments.helpers import short_task
from tests.experiments.study.here import carry_out, parts_in

TASK = short_task(2.5, 1.0, 1.0)
IN_BATCH = EngineRequest.COMPILED


def run(folder: Path, asked: EngineRequest = IN_BATCH) -> StudyPlan[None]:
    plan = make_plan(TASK, [5], parts_in(folder), engine=asked)
    return carry_out(plan, folder)


def witness_of(plan: StudyPlan[None]) -> BusWitnessJob:
    (witness,) = plan.witnesses
    return witness


def test_batch_and_bus_come_to_the_same_result(tmp_path: Path) -> None:
    plan, on_bus = run(tmp_path / "batch"), run(tmp_path / "bus", EngineRequest.CAN)
    results = Results(tmp_path / "batch")
    assert read_results(plan) == read_results(on_bus)
    assert results.read(witness_of(plan), BusWitnessOutcome).differing == ()
    assert results.missing(plan.waves[0]) == []
    require_no_difference(results, ["tested"])
    assert not list((tmp_path / "bus").rglob("witnesses"))


def wrong_exams(*given: object, **named: object) -> list[DriveRow | None]:
    results = examine_in_batch(*given, **named)  # type: ignore[arg-type]
    return [None if each is None else each.model_copy(update={"progress": each.progress + 1e-12}) for each in results]


def wrong_lesson(*given: object, **named: object) -> GivenLesson | None:
    true = teach_in_batch(*given, **named)  # type: ignore[arg-type]
    return true and true._replace(events=true.events[:-1])


@pytest.mark.parametrize(
    ("name", "wrong", "said"),
    [
        ("examine_in_batch", wrong_exams, r"wall_following, seed 5: .* differ in drives\.0\.progress"),
        ("teach_in_batch", wrong_lesson, r"wall_following, seed 5: .* lessons or statistics in the knowledge file"),
    ],
)
def test_one_difference_refuses_the_folder_for_good(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, wrong: object, said: str
) -> None:
    with monkeypatch.context() as patched:
        patched.setattr(curriculum, name, wrong)
        with pytest.raises(BatchDiffersError, match=said):
            run(tmp_path)
    with pytest.raises(BatchDiffersError, match=said):
        require_no_difference(Results(tmp_path), [source_hash()])
    require_no_difference(Results(tmp_path), ["of another program"])


def test_damaged_witness_is_named(tmp_path: Path) -> None:
    plan = run(tmp_path)
    path = tmp_path / witness_of(plan).file
    path.write_text("{}")
    with pytest.raises(StudyError, match=f"{path.name}: is not a witness"):
        require_no_difference(Results(tmp_path), [source_hash()])
