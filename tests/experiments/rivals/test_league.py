"""A league on the simulated robot: the same robots, teacher and exams for all rivals."""

from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path

import anyio
import numpy as np
import pytest
from numpy.typing import NDArray

from kurt2rt.core.event_store import InMemoryEventStore
from kurt2rt.core.learner.learner import LearnerSetting, Why
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.learner.rla_learner import RlaLearner
from kurt2rt.core.rla.events import ActionReplaced, ActionWithdrawn, LessonUndone, RlaCreated, TeachingEvent
from kurt2rt.core.rla.phase import Phase
from kurt2rt.core.rla.rla import Origin, Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.task_settings import TaskSettings, taught_by
from kurt2rt.core.teacher_settings import load_teacher
from kurt2rt.experiments.lockstep.lesson import teach
from kurt2rt.experiments.lockstep.lesson_plan import plan_of
from kurt2rt.experiments.lockstep.runtimes import TrainingStore
from kurt2rt.experiments.rivals.jobs import RivalJob
from kurt2rt.experiments.rivals.learner_clock import LearnerClock
from kurt2rt.experiments.rivals.lesson import RivalLesson, RivalSetup, teach_rival
from kurt2rt.experiments.rivals.outcome import RivalOutcome
from kurt2rt.experiments.rivals.plan import League, read_league
from kurt2rt.experiments.rivals.registry import NoLearnerError
from kurt2rt.experiments.rivals.rival import PLAIN, SHIPPED, Rival
from kurt2rt.experiments.rivals.undo import undo_of_learner, undo_of_rlas
from kurt2rt.experiments.study.plan import missing_time_s, run_missing
from kurt2rt.experiments.study.results import Results
from tests.core.learner.helpers import SETTING, Parrot, label
from tests.experiments.helpers import ROBOT, STAGE, short_task
from tests.experiments.rivals.outcomes import AFTER, plan_for
from tests.experiments.study.here import HERE

RIVALS = (Rival("rla-door"), Rival("weighted-vote"), Rival(f"{__name__}:Breaking"))


class Breaking(RlaLearner):
    """Learner that fails in its fourth lesson."""

    lessons = 0

    def lesson(self, situation: NDArray[np.float64], action: str, why: Why) -> None:
        super().lesson(situation, action, why)
        self.lessons += 1
        if self.lessons == 4:
            raise RuntimeError("four are too many")


@dataclass(frozen=True)
class Done:
    results: Results
    league: League

    def outcome(self, name: str) -> RivalOutcome:
        (row,) = (row for row in self.league.rows if row.entry.rival.name == name)
        return row.outcomes[0]


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> Done:
    results = Results(tmp_path_factory.mktemp("league"))
    plan = plan_for(results, (3902,), *RIVALS)
    with results.held():
        run_missing(plan, results, HERE, lambda _: None)
    return Done(results, read_league(plan, results))


def test_shipped_rla_system_is_the_first_row(done: Done) -> None:
    assert [row.entry.rival.name for row in done.league.rows][:2] == [SHIPPED, "rla-door"]
    assert missing_time_s(done.league.plan, done.results) == 0.0


def test_each_rival_is_examined_after_presses_and_at_the_end(done: Done) -> None:
    for row in done.league.rows:
        (outcome,) = row.outcomes
        assert [each.presses for each in outcome.checkpoints[:-1]] == list(AFTER)
        assert outcome.presses == outcome.checkpoints[-1].presses
        assert outcome.failure or outcome.presses > AFTER[-1]
        seconds = [each.teaching_s for each in outcome.checkpoints]
        assert seconds == sorted(seconds)
        assert seconds[-1] == outcome.teaching_s == 15.0
        assert all(len(each.drives) == 1 for each in outcome.checkpoints)
        assert outcome.undo_restores
        assert outcome.knowledge_bytes > 500
        assert 0.0 < outcome.waited_s < outcome.teaching_s


def test_only_learners_have_times_of_their_own(done: Done) -> None:
    assert done.outcome(SHIPPED).retraining_s == 0.0
    assert done.outcome("weighted-vote").retraining_s > 0.0
    assert done.outcome("weighted-vote").longest_decision_ms > 0.0


def test_lessons_of_rlas_are_followed_at_once(done: Done) -> None:
    assert [done.outcome(name).followed_share for name in (SHIPPED, "rla-door")] == [1.0, 1.0]
    share = done.outcome("weighted-vote").followed_share
    assert share is not None
    assert 0.5 < share <= 1.0
    assert all(ticks >= 1 for row in done.league.rows for ticks in row.outcomes[0].change_ticks)


def test_failure_of_a_learner_is_told_and_fails_the_exam(done: Done) -> None:
    failed = done.outcome(f"{__name__}:Breaking")
    assert failed.failure == f"{__name__}:Breaking: RuntimeError: four are too many"
    assert [each.passed for each in failed.checkpoints][-1] is False
    assert done.outcome("weighted-vote").failure == ""


def test_jobs_of_another_gate_have_another_provenance(tmp_path: Path) -> None:
    plan = plan_for(Results(tmp_path), (3902,), Rival("k-nn"), Rival("k-nn", 0.5), Rival(PLAIN))
    jobs = [entry.jobs[0] for entry in plan.entries]
    assert len({job.made_of for job in jobs}) == 4
    assert [job.stem for job in jobs] == [
        "rla/wall_following-3902",
        "k-nn/wall_following-3902",
        "k-nn-gate-0.5/wall_following-3902",
        "rla-plain/wall_following-3902",
    ]
    assert jobs[3].task.learning.radius == 300.0
    assert jobs[0].task.learning.radius == 900.0


def lesson_of(task: TaskSettings, team: LearnerTeam | None) -> RivalLesson:
    async def lesson() -> RivalLesson:
        with closing(STAGE.open(task.teaching.world, 3903, "lesson")) as simulation:
            setup = RivalSetup(robot=ROBOT, task=task, seed=3903, team=team, after=AFTER)
            return await teach_rival(simulation, setup, lambda _: None)

    return anyio.run(lesson)


def events_until_press(task: TaskSettings, most: int) -> list[TeachingEvent]:
    """Return the lessons of a training run that its plan ends before another press."""
    store = InMemoryEventStore()

    async def lesson() -> None:
        with closing(STAGE.open(task.teaching.world, 3903, "lesson")) as simulation:
            plan = replace(plan_of(task), most_presses=most)
            training = TrainingStore(store)
            await teach(simulation, ROBOT, task, training, seed=3903, on_progress=lambda _: None, plan=plan)

    anyio.run(lesson)
    return store.events


def test_mark_holds_what_a_lesson_of_so_many_presses_teaches() -> None:
    task = taught_by(short_task(15.0, 15.0), load_teacher("ordinary"))
    lesson = lesson_of(task, None)
    assert [mark.presses for mark in lesson.marks[:-1]] == list(AFTER)
    for mark in lesson.marks[:-1]:
        assert list(mark.events) == events_until_press(task, mark.presses)
        assert mark.lessons == ()
    assert len(lesson.marks[-1].events) > len(lesson.marks[-2].events)


def test_marks_that_are_not_reached_are_of_the_end() -> None:
    task = taught_by(short_task(4.0, 1.0), load_teacher("superhuman"))
    team = Rival("1-nn").new_team(task, ROBOT, 3903)
    lesson = lesson_of(task, team)
    assert lesson.result.presses < AFTER[-1]
    assert lesson.marks[1].lessons == lesson.marks[-1].lessons == team.lessons
    assert lesson.marks[1].presses == AFTER[-1]


class Slow(Parrot):
    """Parrot by whose undo something is left over."""

    made = 0

    def __init__(self, setting: LearnerSetting) -> None:
        super().__init__(setting)
        Slow.made += 1
        if Slow.made > 2:
            self.said = ["c"]

    def lesson(self, situation: NDArray[np.float64], action: str, why: Why) -> None:
        if Slow.made <= 2:
            super().lesson(situation, action, why)


def test_undo_that_restores_other_decisions_is_seen() -> None:
    labels = (label(1.0, "a", "t-1"), label(2.0, "b", "t-2"))
    for kind, restores in ((Parrot, True), (Slow, False)):
        team, other = (LearnerTeam("it", kind, SETTING, ("",)) for _ in range(2))
        team.teach_all(labels)
        assert undo_of_learner(team, other).restores is restores
        assert [each.command_id for each in team.labels] == ["t-1"]


def test_undo_of_rlas_is_compared_at_the_whole_radius() -> None:
    taught, other = RlaSystem(1, 10.0), RlaSystem(1, 10.0)
    created = [
        RlaCreated(Rla(number, (place,), "a", None, Origin(f"t-{number}", "Ann", Phase.SUPERVISED, number)))
        for number, place in enumerate((0.0, 3.0, 100.0), 1)
    ]
    withdrawn = ActionWithdrawn(2, "a", Origin("w-1", "Ann", Phase.REINFORCEMENT, 4))
    events: list[TeachingEvent] = [*created[:2], withdrawn, created[2]]
    taught.apply_all(events)
    taught.radius_share = 0.1
    assert undo_of_rlas(taught, other, events).restores
    assert [rla.rla_id for rla in taught.rlas] == [1, 2]


def test_undo_of_rlas_with_an_undone_lesson_about_the_last() -> None:
    taught, other = RlaSystem(1, 10.0), RlaSystem(1, 10.0)
    created = [
        RlaCreated(Rla(number, (place,), "a", None, Origin(f"t-{number}", "Ann", Phase.SUPERVISED, number)))
        for number, place in enumerate((0.0, 30.0), 1)
    ]
    slip = ActionReplaced(2, "b", "a", Origin("c-1", "Ann", Phase.CORRECTIONS, 3))
    events: list[TeachingEvent] = [*created, slip, LessonUndone("c-1", Origin("u-1", "Ann", Phase.CORRECTIONS, 4))]
    taught.apply_all(events)
    assert undo_of_rlas(taught, other, events).restores
    assert [rla.rla_id for rla in taught.rlas] == [1]


def test_clock_counts_the_decision_after_a_lesson() -> None:
    clock = LearnerClock()
    learner = clock.timed(Parrot)(SETTING)
    learner.decide(np.zeros(1), taught=True)
    assert clock.retraining_ns == 0 < clock.longest_ns
    learner.lesson(np.zeros(1), "a", Why.ANSWER)
    after_lesson = clock.retraining_ns
    assert learner.decide(np.zeros(1), taught=True) == "a"
    after_decision = clock.retraining_ns
    learner.decide(np.zeros(1), taught=True)
    assert 0 < after_lesson < after_decision == clock.retraining_ns
    other = Parrot(SETTING)
    other.restore(learner.snapshot())
    assert other.said == ["a"]


@pytest.mark.parametrize(
    ("text", "found"), [("k-nn", Rival("k-nn")), ("k-nn=0.5", Rival("k-nn", 0.5)), (SHIPPED, Rival(SHIPPED))]
)
def test_rival_of_a_text(text: str, found: Rival) -> None:
    assert Rival.parse(text) == found


@pytest.mark.parametrize("text", ["k-nn=wide", "rla=1", "no-such"])
def test_rival_of_another_text_is_refused(text: str) -> None:
    with pytest.raises(NoLearnerError):
        Rival.parse(text)


def test_rival_job_names_its_row(done: Done) -> None:
    job: RivalJob = done.league.rows[2].entry.jobs[0]
    assert job.name == "wall_following, locally weighted vote with R, seed 3902"
    assert job.knowledge_name is None
