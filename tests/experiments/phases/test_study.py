"""Phases study on the simulated robot: plan, results, figures and report."""

import base64
from dataclasses import dataclass
from pathlib import Path

import pytest
from matplotlib.image import imread

from kurt2rt.core.rla.events import ActionReplaced, Appraised, RlaCreated, TeachingEvent
from kurt2rt.core.rla.rla import CRITIC
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.phases.results import PhasesStudy, read_study
from kurt2rt.experiments.phases.steps import Step
from kurt2rt.experiments.phases.study import PhasesTask, make_plan
from kurt2rt.experiments.phases.tables import tell
from kurt2rt.experiments.study.jobs import StudyError
from kurt2rt.experiments.study.pool import PoolProgress
from kurt2rt.experiments.study.study_plan import StudyPlan
from kurt2rt.experiments.study.table import Told
from kurt2rt.knowledge.journal.loading import read_lessons
from tests.experiments.helpers import ROBOT
from tests.experiments.study.here import carry_out, parts_in
from tests.experiments.study.page import Page

COMMAND = "kurt2rt study phases --task wall_following --seeds 100"


@dataclass(frozen=True)
class Tiny:
    """The smallest run with all kinds of results: too short to teach anything."""

    folder: Path
    study: PhasesStudy
    told: Told

    @property
    def plan(self) -> StudyPlan[PhasesTask]:
        return self.study.plan


def tiny_task() -> TaskSettings:
    task = load_task("wall_following")
    assert task.phases is not None
    teaching = task.teaching.model_copy(update={"supervised_s": 4.0, "corrections_s": 1.0})
    exam = task.exam.model_copy(update={"worlds": ("a",), "duration_s": 0.5})
    phases = task.phases.shortened(1.0, ("a",), 1.0, 0.5).model_copy(update={"critic_s": 4.0, "set_down_every_s": 2.0})
    return task.model_copy(update={"teaching": teaching, "exam": exam, "phases": phases})


def tiny_plan(folder: Path) -> StudyPlan[PhasesTask]:
    return make_plan(tiny_task(), (100,), parts_in(folder))


@pytest.fixture(scope="module")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> Tiny:
    folder = tmp_path_factory.mktemp("phases")
    plan = carry_out(tiny_plan(folder), folder)
    return Tiny(folder, read_study(plan), tell(plan, COMMAND))


def file_of(step: str) -> str:
    return f"results/{step}/wall_following-100.json"


def lessons(tiny: Tiny, step: str) -> list[TeachingEvent]:
    return list(read_lessons(tiny.folder / f"knowledge/{step}/wall_following-100.knowledge", ROBOT, tiny_task()))


def test_phases_run_stores_stages_and_knowledge(tiny: Tiny) -> None:
    assert set(tiny.study.stages) == set(Step)
    assert all(job.knowledge.is_file() for job in tiny.plan.jobs)
    (long_run,) = tiny.study.stages[Step.LONG_RUN].rows
    assert long_run.exams == ()


def test_the_critic_of_phase_4_goes_along_to_the_branches(tiny: Tiny) -> None:
    (taught,) = tiny.study.stages[Step.PHASE_4].rows
    assert taught.appraisals > 0
    assert taught.teaching is not None
    assert sum(minute.appraisals for minute in taught.teaching.workload) > 0
    for step in (Step.CRITIC_ALONE, Step.SHUFFLED):
        (branch,) = tiny.study.stages[step].rows
        assert branch.appraisals == taught.appraisals
        assert any(isinstance(event, RlaCreated) and event.rla.level == CRITIC for event in lessons(tiny, step))


def test_phase_4_changes_the_critic_alone(tiny: Tiny) -> None:
    (before,), (after,) = tiny.study.stages[Step.PHASE_3].rows, tiny.study.stages[Step.PHASE_4].rows
    assert (after.rlas, after.exams) == (before.rlas, before.exams)
    brought = lessons(tiny, Step.PHASE_4)[len(lessons(tiny, Step.PHASE_3)) :]
    assert brought
    made = [event.rla for event in brought if isinstance(event, RlaCreated)]
    assert {rla.level for rla in made} == {CRITIC}
    assert all(isinstance(event, RlaCreated | Appraised | ActionReplaced) for event in brought)


def test_interrupted_run_completes_to_equal_results(tiny: Tiny, tmp_path: Path) -> None:
    left_out = {file_of(step) for step in (Step.CORRUPTED, Step.LONG_RUN)}
    for path in tiny.folder.rglob("*-100.*"):
        name = path.relative_to(tiny.folder)
        if str(name) not in left_out:
            (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / name).write_bytes(path.read_bytes())
    seen: list[PoolProgress] = []
    plan = carry_out(tiny_plan(tmp_path), tmp_path, seen.append)
    titles = {f"{step.label}, seed 100" for step in (Step.CORRUPTED, Step.LONG_RUN)}
    assert {name for progress in seen for name in progress.running} == titles
    assert seen[-1].done_s == sum(job.robot_time_s for job in plan.jobs if job.file in left_out)
    assert read_study(plan).stages == tiny.study.stages


def test_missing_knowledge_and_results_are_named(tmp_path: Path) -> None:
    plan = tiny_plan(tmp_path)
    (job,) = [job for job in plan.jobs if job.file == file_of(Step.CORRUPTED)]
    with pytest.raises(StudyError, match=r"phase-2/\S+\.knowledge .*\S+100\.json "):
        job.run(lambda _: None)
    with pytest.raises(StudyError):
        read_study(plan)


def test_report_holds_all_figures_and_tables(tiny: Tiny) -> None:
    text = (tiny.folder / "report.html").read_text(encoding="utf-8")
    page = Page(text)
    drawn = [tiny.folder / f"{name}.png" for name in ("phases", "load", "agreement", "branches", "intact")]
    pictures = [base64.b64decode(address.removeprefix("data:image/png;base64,")) for address in page.addresses]
    assert pictures == [path.read_bytes() for path in drawn]
    assert all(min(imread(path).shape[:2]) > 400 for path in drawn)
    titles = [table.title for table in tiny.told.tables]
    assert len(titles) == len(set(titles))
    assert all(f"<caption>{title}</caption>" in text for title in titles)
    assert page.tags.count("table") == len(titles) + 1  # and that of the settings
    assert f"<code>{COMMAND}</code>" in text
    assert "1 robot only" in text
    assert "MISSED" not in text  # seconds judge nothing
    assert "<script" not in text
    assert str(tiny.folder) not in text
