"""Transfer study on the simulated robot: home, a new world, checkpoints, controls and figure."""

from dataclasses import dataclass, replace
from pathlib import Path

import pytest
from matplotlib.image import imread

from config.settings import SettingsError
from kurt2rt.core.rla.events import RlaCreated
from kurt2rt.core.rla.rla import Origin, Phase, Rla
from kurt2rt.experiments.study.examination import events_before_press
from kurt2rt.experiments.study.jobs import Results
from kurt2rt.experiments.study.study_plan import StudyPlan
from kurt2rt.experiments.transfer import HomeJob, Transfer, TransferJob, TransferOutcome, make_plan, read_study, tell
from tests.experiments.helpers import short_task
from tests.experiments.study.here import carry_out, parts_in
from tests.knowledge.reading import events_in

AFTER = (0, 2, 5)
NEW = Transfer(short_task(exam_s=4.0), ("rooms-SEED",), AFTER, 15.0)


def plan_in(folder: Path, new: Transfer = NEW) -> StudyPlan[Transfer]:
    return make_plan(new, (1,), parts_in(folder))


@dataclass(frozen=True)
class Done:
    results: Results
    plan: StudyPlan[Transfer]

    @property
    def job(self) -> TransferJob:
        (job,) = self.plan.of(TransferJob)
        return job

    @property
    def outcome(self) -> TransferOutcome:
        return self.results.read(self.job, TransferOutcome)


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> Done:
    folder = tmp_path_factory.mktemp("transfer")
    plan = carry_out(plan_in(folder), folder)
    return Done(Results(folder), plan)


def test_robot_goes_on_from_what_it_was_taught_at_home(done: Done) -> None:
    (home,) = done.plan.of(HomeJob)
    before, after = events_in(home.knowledge), events_in(done.job.knowledge)
    outcome = done.outcome
    assert outcome.lesson.world == "rooms-1"
    assert after[: len(before)] == before
    assert len(after) - len(before) == outcome.checkpoints[-1].lessons >= 1
    assert {event.origin.phase for event in after[len(before) :]} == {Phase.CORRECTIONS}


def test_checkpoint_is_what_a_shorter_lesson_teaches(done: Done) -> None:
    job = done.job
    shorter = replace(job, about=NEW._replace(after=(0, 2)), stem="shorter")
    shorter.run(lambda _: None)
    outcome = done.results.read(shorter, TransferOutcome)
    _, point, _ = done.outcome.checkpoints
    assert outcome.lesson.presses == 2
    known = len(events_in(done.plan.of(HomeJob)[0].knowledge))
    assert events_in(shorter.knowledge) == events_in(job.knowledge)[: known + point.lessons]
    assert outcome.checkpoints[-1] == point


def test_lessons_of_a_press_come_before_the_next_press() -> None:
    def lesson(tick: int) -> RlaCreated:
        origin = Origin(f"c-{tick}", "Ann", Phase.CORRECTIONS, tick)
        return RlaCreated(Rla(tick, (0.0,), "forward", None, origin))

    events = [lesson(tick) for tick in (101, 111, 121, 301)]
    assert [events_before_press(events, (100, 300), presses) for presses in range(4)] == [0, 3, 4, 4]
    assert events_before_press(events, (), 0) == 4


def test_robot_that_was_not_taught_on_drives_at_home_as_before(done: Done) -> None:
    job = replace(done.job, about=NEW._replace(after=(0,)), stem="not-taught")
    job.run(lambda _: None)
    outcome, (before,) = done.results.read(job, TransferOutcome), read_study(done.plan).home.rows
    assert outcome.lesson.presses == outcome.checkpoints[0].lessons == 0
    assert outcome.home == outcome.home_when_right == before.home


def test_tables_and_figure_show_each_world(done: Done) -> None:
    told = tell(done.plan, "kurt2rt study transfer")
    _, curve, teaching, robots = told.tables
    assert [row[:2] for row in curve.rows] == [("rooms-SEED", "taught on"), ("rooms-SEED", "until right")]
    assert len(teaching.rows) == 1
    assert [row[:2] for row in robots.rows] == [("1", "rooms-1")]
    assert imread(told.files["figure"]).shape[0] > 300
    page = told.files["report"].read_text(encoding="utf-8")
    # The sentence and the picture first, then all tables.
    assert page.index(told.sentence) < page.index("<img") < page.index(robots.title)


def test_home_is_no_new_world(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match=r"world a\b"):
        plan_in(tmp_path, NEW._replace(places=("a",)))
