"""Certificate of a robot in the real simulator: batch and CAN bus agree, and a difference refuses all."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import anyio
import numpy as np
import pytest
from matplotlib.figure import Figure

from config.settings import SettingsError
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.certify import (
    BlockJob,
    BlockOutcome,
    Certified,
    Extent,
    Run,
    all_tables,
    draw_runs,
    draw_together,
    draw_worst,
    make_plan,
    picture_jobs,
    read_drives,
    summarise,
)
from kurt2rt.experiments.lockstep import curriculum
from kurt2rt.experiments.lockstep.batch_exam import examine_in_batch
from kurt2rt.experiments.lockstep.curriculum import run_drives
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.lockstep.engine import BatchDiffersError, Engine
from kurt2rt.experiments.lockstep.exam import ExamSetup
from kurt2rt.experiments.study.jobs import Results
from kurt2rt.experiments.study.remote_job import pack, run_remote_job
from kurt2rt.experiments.study.study_plan import StudyPlan
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from simbridge.batch.compiled import IS_COMPILED
from tests.experiments.helpers import ROBOT, STAGE, Taught, short_task, teach
from tests.experiments.rows import row
from tests.experiments.study.here import carry_out, parts_in
from tests.simbridge.batch.equal_lessons import batch_lesson

SECONDS = 12.0 if IS_COMPILED else 2.0
EXTENT = Extent(first=20_000, runs=4, places=("c", "rooms-SEED"))


Made = tuple[Path, StudyPlan[Certified]]


def ignore(_done_s: float) -> None:
    """Take no progress."""


def plan_in(
    folder: Path, taught: Taught, extent: Extent = EXTENT, task: TaskSettings | None = None
) -> StudyPlan[Certified]:
    """Return a plan with results in a folder."""
    return make_plan(task or short_task(exam_s=SECONDS), taught.knowledge, extent, parts_in(folder))


@pytest.fixture(scope="module")
def made(taught: Taught, tmp_path_factory: pytest.TempPathFactory) -> Made:
    """Return the folder of a certificate, and the certificate."""
    folder = tmp_path_factory.mktemp("certify")
    return folder, carry_out(plan_in(folder, taught), folder)


def driven(task: TaskSettings, events: Sequence[TeachingEvent], runs: Sequence[Run], engine: Engine) -> list[DriveRow]:
    """Return the drives of runs as a certificate stores them."""

    async def drive() -> list[DriveRow]:
        exams = [ExamSetup(run.world, run.number, events=events) for run in runs]
        return await run_drives(STAGE, ROBOT, task, exams, lambda *_: None, engine, measured=False)

    return [each.stored() for each in anyio.run(drive)]


def require_equal(task: TaskSettings, events: Sequence[TeachingEvent], runs: Sequence[Run]) -> None:
    """Check that runs have equal drives in the batch and on the bus."""
    exams = [ExamSetup(run.world, run.number, events=events) for run in runs]
    assert None not in examine_in_batch(STAGE, ROBOT, task, exams, measured=False)
    assert driven(task, events, runs, Engine.COMPILED) == driven(task, events, runs, Engine.CAN)


@pytest.mark.parametrize("name", ["streets", pytest.param("straight_on", marks=pytest.mark.deep)])
def test_drives_in_streets_are_those_of_the_bus(name: str) -> None:
    times = {"supervised_s": SECONDS, "corrections_s": 2 * SECONDS}
    changes = {f"teaching.{key}": str(seconds) for key, seconds in times.items()}
    lengths = {"exam.duration_s": str(3 * SECONDS), "exam.stuck_after_s": str(SECONDS)}
    task = load_task(name, changes={**changes, **lengths})
    with batch_lesson(task, 2) as lesson:
        assert lesson.drive_stretches()
        events = lesson.given().events
    worlds = ("manhattan", "streets-5", "streets-6")
    require_equal(task, events, [Run(number, world) for number, world in enumerate(worlds, start=20_010)])


def test_certificate_has_all_runs_and_equal_witnesses(made: Made) -> None:
    _, plan = made
    drives = read_drives(plan)
    assert [each.seed for each in drives] == [20_000, 20_001, 20_002, 20_003]
    assert len(plan.witnesses) == 3
    assert all(0 < each.duration_s <= SECONDS for each in drives)
    probabilities, rates = all_tables(plan, list(summarise(plan, drives)), [])
    assert [row[0] for row in probabilities.rows] == [row[0] for row in rates.rows]
    assert probabilities.rows[-1][:2] == ("all", "4")
    assert "3 runs were driven on the CAN bus too, with equal results." in probabilities.note


def test_worker_on_another_machine_gives_the_same_files(made: Made, tmp_path: Path) -> None:
    folder, plan = made
    block, own = plan.of(BlockJob)[0], tmp_path / "own.knowledge"
    witness = plan.witnesses[0]
    assert isinstance(witness.of, BlockJob)
    content = block.taught.read_bytes()
    moved_block = replace(block, taught=own, results=Results(tmp_path))
    moved_witness = replace(witness, of=replace(witness.of, taught=own), results=Results(tmp_path))
    for job, moved in ((block, moved_block), (witness, moved_witness)):
        own.write_bytes(content)  # also knowledge within the folder of results travels
        assert run_remote_job(pack(moved, moved.results, ())) == {job.file: (folder / job.file).read_bytes()}
        own.unlink()
        with pytest.raises(KnowledgeError):
            run_remote_job(pack(moved, moved.results, ()))


def test_worst_runs_are_driven_again_and_drawn(made: Made, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _, plan = made
    worst = read_drives(plan)[:1]
    (job,) = (replace(job, results=Results(tmp_path)) for job in picture_jobs(plan, worst))
    job.run(ignore)
    (picture,) = draw_worst([job], ["kurt2rt exam"])
    assert picture.path == tmp_path / f"run-{worst[0].seed}.png"
    drawn: list[Figure] = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: drawn.append(figure))
    draw_together([job], [row(seed=seed, collisions=seed // 24) for seed in range(1, 25)])
    (axes,) = drawn[0].axes
    assert drawn[0].get_suptitle() == "23 of 24, at least 80%"
    assert axes.get_title().endswith(f": run {worst[0].seed}")
    (drive,) = job.results.read(job, BlockOutcome).drives
    assert tuple(np.asarray(axes.lines[0].get_xydata())[-1]) == drive.trail[-1][:2]
    with pytest.raises(BatchDiffersError, match=rf"run {worst[0].seed} in world"):
        replace(job, before=worst[0].model_copy(update={"collisions": 99})).run(ignore)


def test_witness_with_another_outcome_refuses_all(
    taught: Taught, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def wrong(*given: object, **named: object) -> list[DriveRow | None]:
        (found,) = examine_in_batch(*given, **named)  # type: ignore[arg-type]
        assert found is not None
        return [found.model_copy(update={"way_m": found.way_m + 1e-9})]

    monkeypatch.setattr(curriculum, "examine_in_batch", wrong)
    with pytest.raises(BatchDiffersError, match=r"run 2000\d in world .* differ in drives\.0\.way_m"):
        carry_out(plan_in(tmp_path, taught), tmp_path)


def test_runs_with_a_broken_sensor_have_a_row_of_their_own(taught: Taught, tmp_path: Path) -> None:
    extent = EXTENT._replace(runs=3, places=("a",), broken_share=1.0)
    plan = carry_out(plan_in(tmp_path, taught, extent, short_task(exam_s=6.0)), tmp_path)
    drives = read_drives(plan)
    assert [summary.place for summary in summarise(plan, drives)] == ["a sensor breaks"]
    assert all(run.broken for run in plan.about.runs)
    stopped = [each for each in drives if each.alarm]
    assert stopped
    assert {each.alarm.partition(" broken ")[0] for each in stopped} == {"sensor"}
    assert all(2.0 < each.duration_s < 6.0 and not each.stuck for each in stopped)


@pytest.mark.parametrize(("runs", "witnesses"), [(1000, 9), (50, 3), (2, 2)])
def test_witnesses_are_a_share_of_the_runs_without_a_break(
    taught: Taught, tmp_path: Path, runs: int, witnesses: int
) -> None:
    plan = plan_in(tmp_path, taught, EXTENT._replace(first=0, runs=runs, broken_share=0.2))
    chosen = {run for job in plan.witnesses if isinstance(job.of, BlockJob) for run in job.of.runs}
    assert len(chosen) == witnesses
    assert chosen <= {run for run in plan.about.runs if not run.broken}


def test_plan_refuses_knowledge_without_a_lesson(taught: Taught, tmp_path: Path) -> None:
    from kurt2rt.knowledge.journal.loading import open_knowledge

    empty = tmp_path / "empty.knowledge"
    open_knowledge(empty, ROBOT, taught.task).close()
    with pytest.raises(SettingsError, match="holds no lesson"):
        make_plan(short_task(), empty, EXTENT, parts_in(tmp_path))


@pytest.mark.deep
def test_all_runs_in_the_batch_have_the_drives_of_the_bus(tmp_path: Path) -> None:
    lesson = teach(tmp_path / "k", short_task(supervised_s=60.0, corrections_s=120.0, exam_s=40.0))
    runs = draw_runs(Extent(21_000, 20, ("a", "b", "c", "rooms-SEED", "floors-SEED")))
    batch, bus = (driven(lesson.task, lesson.events, runs, engine) for engine in (Engine.COMPILED, Engine.CAN))
    assert batch == bus
