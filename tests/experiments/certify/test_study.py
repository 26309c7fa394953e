"""Certificate of a robot in the real simulator: batch and CAN bus agree, and a difference refuses all."""

import json
from dataclasses import replace
from pathlib import Path

import anyio
import pytest

from hal.settings import SettingsError
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.certify.drives import Subject, drive_in_batch, drive_on_bus
from kurt2rt.experiments.certify.run import BrokenShare, Run, draw_runs
from kurt2rt.experiments.certify.study import (
    BlockJob,
    Certificate,
    Certified,
    Extent,
    WitnessJob,
    drive_again,
    make_plan,
    read_certificate,
)
from kurt2rt.experiments.certify.tables import all_tables, draw_worst, summarise, worst_runs
from kurt2rt.experiments.lockstep.engine import BatchDiffersError, Engine
from kurt2rt.experiments.study.jobs import StudyJob
from kurt2rt.experiments.study.parcel import pack, run_parcel
from kurt2rt.experiments.study.results import Results
from kurt2rt.experiments.study.study_plan import StudyPlan
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from simbridge.batch.compiled import IS_COMPILED
from tests.experiments.helpers import ROBOT, STAGE, Taught, short_task, teach
from tests.experiments.study.here import carry_out, parts_in
from tests.simbridge.batch.equal_lessons import batch_lesson

SECONDS = 12.0 if IS_COMPILED else 2.0
EXTENT = Extent(first=20_000, runs=4, places=("c", "rooms-SEED"), engine=Engine.COMPILED)


def ignore(_done_s: float) -> None:
    """Take no progress."""


def plan_in(
    folder: Path, taught: Taught, extent: Extent = EXTENT, task: TaskSettings | None = None
) -> StudyPlan[Certified]:
    """Return a plan with results in a folder."""
    return make_plan(task or short_task(exam_s=SECONDS), taught.knowledge, extent, parts_in(folder))


@pytest.fixture(scope="module")
def made(taught: Taught, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Certificate]:
    """Return the folder of a certificate, and the certificate."""
    folder = tmp_path_factory.mktemp("certify")
    return folder, read_certificate(carry_out(plan_in(folder, taught), folder))


@pytest.mark.parametrize("run", [Run(1, "b"), Run(2, "rooms-SEED"), Run(3, "a"), Run(20_005, "c")])
def test_outcome_in_the_batch_is_that_of_the_bus(taught: Taught, run: Run) -> None:
    subject = Subject(ROBOT, short_task(exam_s=SECONDS, stuck_after_s=SECONDS / 2), taught.events)
    (in_batch,) = drive_in_batch(STAGE, subject, [run], ignore)
    on_bus, _ = anyio.run(drive_on_bus, STAGE, subject, run, ignore)
    assert in_batch is not None
    assert in_batch.differing(on_bus) == []


@pytest.mark.parametrize("name", ["streets", pytest.param("straight_on", marks=pytest.mark.deep)])
def test_outcomes_in_streets_are_those_of_the_bus(name: str) -> None:
    times = {"supervised_s": SECONDS, "corrections_s": 2 * SECONDS}
    changes = {f"teaching.{key}": str(seconds) for key, seconds in times.items()}
    lengths = {"exam.duration_s": str(3 * SECONDS), "exam.stuck_after_s": str(SECONDS)}
    task = load_task(name, changes={**changes, **lengths})
    with batch_lesson(task, 2) as lesson:
        assert lesson.drive_stretches()
        subject = Subject(ROBOT, task, lesson.given().events)
    runs = [Run(number, world) for number, world in enumerate(("manhattan", "streets-5", "streets-6"), start=20_010)]
    for run, in_batch in zip(runs, drive_in_batch(STAGE, subject, runs, ignore), strict=True):
        on_bus, _ = anyio.run(drive_on_bus, STAGE, subject, run, ignore)
        assert in_batch is not None
        assert in_batch.differing(on_bus) == []


def test_start_in_sight_is_that_of_the_bus() -> None:
    task = load_task("circle", changes={"exam.duration_s": "2", "exam.start": "in_sight"})
    subject, run = Subject(ROBOT, task, ()), Run(4, "one_object")
    on_bus, _ = anyio.run(drive_on_bus, STAGE, subject, run, ignore)
    assert drive_in_batch(STAGE, subject, [run], ignore) == [on_bus]


def test_certificate_has_all_runs_and_equal_witnesses(made: tuple[Path, Certificate]) -> None:
    _, certificate = made
    assert [each.number for each in certificate.outcomes] == [20_000, 20_001, 20_002, 20_003]
    assert certificate.compared == 3
    assert certificate.on_bus == frozenset()
    assert all(0 < each.ticks <= round(SECONDS * 100) for each in certificate.outcomes)


def test_worker_on_another_machine_gives_the_same_files(made: tuple[Path, Certificate], tmp_path: Path) -> None:
    folder, certificate = made
    for job in (certificate.plan.of(BlockJob)[0], certificate.plan.of(WitnessJob)[0]):
        # Also knowledge within the folder of results travels.
        moved = replace(job, taught=tmp_path / "own.knowledge", results=Results(tmp_path))
        moved.taught.write_bytes(job.taught.read_bytes())
        assert run_parcel(pack(moved, moved.results, ())) == {job.file: (folder / job.file).read_bytes()}
        moved.taught.unlink()
        with pytest.raises(KnowledgeError):
            run_parcel(pack(moved, moved.results, ()))


def test_worst_runs_are_driven_again_and_drawn(made: tuple[Path, Certificate], tmp_path: Path) -> None:
    _, certificate = made
    worst = worst_runs(certificate.outcomes, 1)
    exams = drive_again(certificate.plan, worst, 1, lambda _: None)
    assert [(each.seed, each.collisions) for each in exams] == [(each.number, each.collisions) for each in worst]
    pictures = list(draw_worst(exams, ["kurt2rt exam"] * len(exams), STAGE, tmp_path))
    assert [each.path for each in pictures] == [tmp_path / f"run-{each.number}.png" for each in worst]
    assert all(each.path.stat().st_size > 10_000 for each in pictures)


def test_tables_have_a_row_for_each_place_and_for_all(made: tuple[Path, Certificate]) -> None:
    _, certificate = made
    probabilities, rates = list(all_tables(certificate, []))
    assert [row[0] for row in probabilities.rows] == [row[0] for row in rates.rows]
    assert probabilities.rows[-1][:2] == ("all", "4")
    assert "3 runs were driven on the CAN bus too, with equal results." in probabilities.note


def moved_to(folder: Path, plan: StudyPlan[Certified]) -> tuple[StudyJob, ...]:
    return tuple(replace(job, results=Results(folder)) for job in plan.jobs)


def test_witness_with_another_outcome_refuses_all(made: tuple[Path, Certificate], tmp_path: Path) -> None:
    folder, certificate = made
    for path in folder.rglob("*.json"):
        copy = tmp_path / path.relative_to(folder)
        copy.parent.mkdir(parents=True, exist_ok=True)
        stored = json.loads(path.read_text(encoding="utf-8"))
        for each in stored.get("runs", ()):
            each["collisions"] += 1
        copy.write_text(json.dumps(stored), encoding="utf-8")
    with pytest.raises(BatchDiffersError, match=r"run 2000\d in world .* differ in collisions"):
        read_certificate(replace(certificate.plan, jobs=moved_to(tmp_path, certificate.plan)))


def test_witness_job_stores_no_run_that_differs(
    taught: Taught, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan = plan_in(tmp_path, taught)
    whole = WitnessJob.drive_in_batch

    def wrong(job: WitnessJob, *more: object) -> object:
        (found,) = whole(job, *more)  # type: ignore[arg-type]
        assert found is not None
        return [found.model_copy(update={"travelled_m": found.travelled_m + 1e-9})]

    monkeypatch.setattr(WitnessJob, "drive_in_batch", wrong)
    with pytest.raises(BatchDiffersError, match="travelled_m"):
        plan.of(WitnessJob)[0].run(ignore)
    assert list(tmp_path.rglob("*.json")) == []


def test_bus_alone_has_the_outcomes_of_the_batch(made: tuple[Path, Certificate], taught: Taught) -> None:
    folder, certificate = made
    plan = plan_in(folder / "bus", taught, EXTENT._replace(runs=2, engine=Engine.CAN))
    on_bus = read_certificate(carry_out(plan, folder / "bus"))
    assert on_bus.outcomes == certificate.outcomes[:2]
    assert (on_bus.compared, on_bus.on_bus) == (0, frozenset({20_000, 20_001}))
    assert "All runs were driven on the CAN bus." in next(all_tables(on_bus, [])).note


def test_runs_with_a_broken_sensor_have_a_row_of_their_own(taught: Taught, tmp_path: Path) -> None:
    extent = EXTENT._replace(runs=3, places=("a",), broken=BrokenShare(1.0, ("s3",)))
    certificate = read_certificate(carry_out(plan_in(tmp_path, taught, extent, short_task(exam_s=6.0)), tmp_path))
    assert [summary.place for summary in summarise(certificate)] == ["a sensor breaks"]
    assert all(each.broken.startswith("s3=") for each in certificate.outcomes)
    stopped = [each for each in certificate.outcomes if each.stopped]
    assert {each.stopped for each in stopped} == {"sensor broken left mid front (s3)"}
    assert all(200 < each.ticks < 600 and not each.stuck for each in stopped)
    assert certificate.on_bus == {20_000, 20_001, 20_002}


@pytest.mark.parametrize(("runs", "witnesses"), [(1000, 9), (50, 3), (2, 2)])
def test_witnesses_are_a_share_of_the_runs_without_a_break(
    taught: Taught, tmp_path: Path, runs: int, witnesses: int
) -> None:
    plan = plan_in(tmp_path, taught, EXTENT._replace(first=0, runs=runs, broken=BrokenShare(0.2, ("s3",))))
    chosen = {job.witness for job in plan.of(WitnessJob)}
    assert len(chosen) == witnesses
    assert chosen <= {run for run in plan.about.runs if not run.broken}


def test_plan_refuses_knowledge_without_a_lesson(taught: Taught, tmp_path: Path) -> None:
    from kurt2rt.knowledge.journal.loading import open_knowledge

    empty = tmp_path / "empty.knowledge"
    open_knowledge(empty, ROBOT, taught.task).close()
    with pytest.raises(SettingsError, match="holds no lesson"):
        make_plan(short_task(), empty, EXTENT, parts_in(tmp_path))


@pytest.mark.deep
def test_all_runs_in_the_batch_have_the_outcomes_of_the_bus(tmp_path: Path) -> None:
    lesson = teach(tmp_path / "k", short_task(supervised_s=60.0, corrections_s=120.0, exam_s=40.0))
    subject = Subject(ROBOT, lesson.task, lesson.events)
    runs = draw_runs(21_000, 20, ("a", "b", "c", "rooms-SEED", "floors-SEED"))
    compared = 0
    for run, in_batch in zip(runs, drive_in_batch(STAGE, subject, runs, ignore), strict=True):
        if in_batch is not None:
            on_bus, _ = anyio.run(drive_on_bus, STAGE, subject, run, ignore)
            assert in_batch.differing(on_bus) == []
            compared += 1
    assert compared >= 16
