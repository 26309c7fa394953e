"""Transfer study on the simulated robot: home, a new world, checkpoints, controls and figure."""

from dataclasses import dataclass, replace
from pathlib import Path

import pytest
from matplotlib.image import imread

from hal.settings import SettingsError
from kurt2rt.core.rla.events import RlaCreated, TeachingEvent
from kurt2rt.core.rla.phase import Phase
from kurt2rt.core.rla.rla import Origin, Rla
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.plan import missing_time_s, run_missing
from kurt2rt.experiments.study.results import Results, StudyError
from kurt2rt.experiments.transfer.figures import draw_curves
from kurt2rt.experiments.transfer.jobs import TransferJob, events_before_press
from kurt2rt.experiments.transfer.outcome import TransferOutcome
from kurt2rt.experiments.transfer.plan import NewWorlds, TransferPlan, TransferStudy, make_plan, read_study
from kurt2rt.experiments.transfer.tables import all_tables
from kurt2rt.experiments.transfer.variants import CONTROLS, TAUGHT_ON, taught_on_by
from kurt2rt.knowledge.journal.journal import Journal
from tests.experiments.helpers import ROBOT, STAGE, short_task
from tests.experiments.study.here import HERE
from tests.experiments.transfer.outcomes import AFTER, plan_for


@dataclass(frozen=True)
class Done:
    results: Results
    plan: TransferPlan
    study: TransferStudy

    def job(self, variant: str) -> TransferJob:
        (job,) = (job for each in self.plan.experiments for job in each.jobs if each.variant.name == variant)
        return job

    def outcome(self, variant: str) -> TransferOutcome:
        return self.results.read(self.job(variant), TransferOutcome)


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> Done:
    results = Results(tmp_path_factory.mktemp("transfer"))
    plan = plan_for(results, (1,), (TAUGHT_ON, *CONTROLS))
    with results.held():
        run_missing(plan, results, HERE, lambda _: None)
    return Done(results, plan, read_study(plan, results))


def events_of(file: Path) -> list[TeachingEvent]:
    with Journal.read_only(file) as journal:
        return journal.events()


def test_robot_goes_on_from_what_it_was_taught_at_home(done: Done) -> None:
    (home,) = done.plan.home_jobs
    before, after = events_of(home.knowledge), events_of(done.job("taught-on").knowledge)
    outcome = done.outcome("taught-on")
    assert outcome.world == "rooms-1"
    assert after[: len(before)] == before
    assert len(after) - len(before) == outcome.checkpoints[-1].lessons >= 1
    assert {event.origin.phase for event in after[len(before) :]} == {Phase.CORRECTIONS}


def test_checkpoints_grow_by_presses_from_home_knowledge(done: Done) -> None:
    outcome = done.outcome("taught-on")
    assert [each.presses for each in outcome.checkpoints] == list(AFTER)
    lessons = [each.lessons for each in outcome.checkpoints]
    assert lessons[0] == 0
    assert lessons == sorted(lessons)
    assert outcome.checkpoints[-1].teaching_s <= outcome.teaching_s


def test_checkpoint_is_what_a_shorter_lesson_teaches(done: Done) -> None:
    job = done.job("from-nothing")
    shorter = replace(job, after=(0, 2), variant=replace(job.variant, name="shorter"))
    shorter.run(lambda _: None)
    outcome = done.results.read(shorter, TransferOutcome)
    _, point, _ = done.outcome("from-nothing").checkpoints
    assert outcome.presses == 2
    assert events_of(shorter.knowledge) == events_of(job.knowledge)[: point.lessons]
    assert outcome.checkpoints[-1] == point


def test_control_without_home_knowledge_begins_with_nothing(done: Done) -> None:
    outcome = done.outcome("from-nothing")
    assert outcome.checkpoints[0].lessons == 0
    assert outcome.checkpoints[0].drive.share_unknown == 1.0
    assert events_of(done.job("from-nothing").knowledge)[0].origin.phase is Phase.SUPERVISED


def test_answers_only_control_corrects_nothing(done: Done) -> None:
    assert done.outcome("answers-only").corrections == 0


def test_lessons_of_a_press_come_before_the_next_press() -> None:
    def lesson(tick: int) -> RlaCreated:
        origin = Origin(f"c-{tick}", "Ann", Phase.CORRECTIONS, tick)
        return RlaCreated(Rla(tick, (0.0,), "forward", None, origin))

    events = [lesson(tick) for tick in (101, 111, 121, 301)]
    assert [events_before_press(events, (100, 300), presses) for presses in range(4)] == [0, 3, 4, 4]
    assert events_before_press(events, (), 0) == 4


def test_robot_that_was_not_taught_on_drives_at_home_as_before(done: Done) -> None:
    job = replace(done.job("taught-on"), after=(0,), variant=replace(TAUGHT_ON, name="not-taught"))
    job.run(lambda _: None)
    outcome, (before,) = done.results.read(job, TransferOutcome), done.study.home
    assert outcome.presses == outcome.checkpoints[0].lessons == 0
    assert outcome.home == outcome.home_when_right == before.drive


def test_other_teacher_of_the_new_world_is_named() -> None:
    variant = taught_on_by("slow")
    assert variant.title != TAUGHT_ON.title
    assert variant.task(short_task(), "rooms-1").teaching.profile.name == "slow"
    assert taught_on_by(None) == TAUGHT_ON


def test_study_goes_on_where_it_was(done: Done) -> None:
    assert missing_time_s(done.plan, done.results) == 0.0
    with pytest.raises(StudyError):
        missing_time_s(plan_for(done.results, (1,), seconds=14.0), done.results)


def test_tables_and_figure_show_each_variant(done: Done, tmp_path: Path) -> None:
    _, curve, teaching, robots = all_tables(done.study)
    assert [row[1] for row in curve.rows[::2]] == [each.title for each in (TAUGHT_ON, *CONTROLS)]
    assert len(teaching.rows) == 3
    assert [row[:2] for row in robots.rows] == [("1", "rooms-1")]
    draw_curves(done.study, tmp_path / "curve.png")
    assert imread(tmp_path / "curve.png").shape[0] > 300


def test_home_is_no_new_world(tmp_path: Path) -> None:
    parts = JobParts(factory=STAGE, robot=ROBOT, results=Results(tmp_path))
    with pytest.raises(SettingsError, match=r"world a\b"):
        make_plan(short_task(), NewWorlds(("a",)), (1,), (TAUGHT_ON,), parts)


def test_job_tells_its_progress_up_to_its_robot_time(done: Done) -> None:
    job = replace(done.job("taught-on"), variant=replace(TAUGHT_ON, name="told"))
    told: list[float] = []
    job.run(told.append)
    assert told == sorted(told)
    assert 0.0 < told[-1] <= job.robot_time_s + 1.0
