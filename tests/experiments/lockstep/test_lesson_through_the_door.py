"""The RLA system as a learner: lessons and exams through the door are those of the robot's own RLA level.

Left out are the parts of the level that a learner is not told of: doubt, guesses that are passed over, and holds that
yield to answers.
"""

from contextlib import closing
from dataclasses import dataclass

import anyio
import pytest

from kurt2rt.core.event_store import InMemoryEventStore
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.learner.rla_learner import RlaLearner
from kurt2rt.core.rla.events import LessonUndone
from kurt2rt.core.task_settings import TaskSettings, load_task, taught_by
from kurt2rt.core.teacher_settings import load_teacher
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.lockstep.exam import ExamSetup, examine
from kurt2rt.experiments.lockstep.learner_setting import learner_setting
from kurt2rt.experiments.lockstep.lesson import TrainingResult, teach
from kurt2rt.experiments.lockstep.runtimes import TrainingStore
from tests.experiments.helpers import ROBOT, STAGE


@dataclass(frozen=True)
class Robot:
    """Lesson and exam of one robot."""

    lesson: TrainingResult
    exam: DriveRow
    store: InMemoryEventStore


def task_of(name: str, teacher: str, seconds: float) -> TaskSettings:
    task = load_task(name)
    plain = {"doubt": None, "skip_uncertain_lessons": False, "answers_override_holds": False}
    parts = {
        "learning": task.learning.model_copy(update=plain),
        "teaching": task.teaching.model_copy(update={"supervised_s": seconds / 2, "corrections_s": seconds / 2}),
        "exam": task.exam.model_copy(update={"duration_s": seconds / 2}),
    }
    return taught_by(task.model_copy(update=parts), load_teacher(teacher))


def drive(task: TaskSettings, seed: int, team: LearnerTeam | None) -> Robot:
    store = InMemoryEventStore()

    async def lesson() -> TrainingResult:
        with closing(STAGE.open(task.teaching.world, seed, "lesson")) as simulation:
            training = TrainingStore(store, learners=team)
            return await teach(simulation, ROBOT, task, training, seed=seed, on_progress=lambda _: None)

    async def exam() -> DriveRow:
        world = task.exam.worlds[0]
        with closing(STAGE.open(world, seed, "exam")) as simulation:
            setup = ExamSetup(world, seed, events=store.events, learners=team)
            return await examine(simulation, ROBOT, task, setup, lambda _: None)

    return Robot(anyio.run(lesson), anyio.run(exam), store)


@pytest.mark.parametrize(
    ("name", "teacher", "seconds", "seed"),
    [
        ("wall_following", "superhuman", 16.0, 3501),
        pytest.param("wall_following", "ordinary", 120.0, 3502, marks=pytest.mark.deep),
        pytest.param("streets", "ordinary", 60.0, 3503, marks=pytest.mark.deep),  # three behaviours
    ],
)
def test_rla_learner_drives_as_the_rla_level(name: str, teacher: str, seconds: float, seed: int) -> None:
    task = task_of(name, teacher, seconds)
    team = LearnerTeam("rla", RlaLearner, learner_setting(task, ROBOT, seed=seed), task.behaviours)
    own, by_learner = drive(task, seed, None), drive(task, seed, team)
    assert by_learner.lesson.trail == own.lesson.trail
    assert by_learner.lesson.ask_positions == own.lesson.ask_positions
    assert by_learner.lesson.press_ticks == own.lesson.press_ticks
    assert by_learner.store.events == own.store.events  # taught to the RLAs, too, as the journal's record
    assert by_learner.exam == own.exam
    assert own.lesson.counts.presses > 5
    if name == "wall_following" and teacher == "ordinary":
        assert any(isinstance(event, LessonUndone) for event in own.store.events)
    assert own.exam.way_m > 1.0
    for behaviour in task.behaviours:
        mirror = RlaLearner(learner_setting(task, ROBOT, seed=seed))
        for rla in own.lesson.rlas:
            if rla.behaviour == behaviour:
                mirror.insert(tuple(rla.condition), rla.action)
        assert team.learner(behaviour).snapshot() == mirror.snapshot()
