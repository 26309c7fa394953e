"""Lessons of a study in a batch."""

from dataclasses import replace
from pathlib import Path

import pytest

from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.lockstep import curriculum
from kurt2rt.experiments.lockstep.batch_mind import require_known_lesson
from kurt2rt.experiments.lockstep.engine import Engine
from kurt2rt.experiments.lockstep.lesson import GivenLesson
from kurt2rt.experiments.lockstep.lesson_plan import plan_of
from kurt2rt.knowledge.journal.loading import read_knowledge
from simbridge.contracts.batch import BatchRefusedError
from tests.experiments.helpers import ROBOT, short_task, teach
from tests.simbridge.batch.equal_lessons import require_equal_lessons

TASK = short_task(supervised_s=3.0, corrections_s=1.0, exam_s=1.0)


def lesson(file: Path, engine: Engine) -> GivenLesson:
    taught = teach(file, TASK, engine=engine)
    return GivenLesson(taught.result, taught.events)


def test_file_of_a_lesson_in_a_batch_is_that_of_the_bus(tmp_path: Path) -> None:
    batch, bus = lesson(tmp_path / "batch", Engine.COMPILED), lesson(tmp_path / "bus", Engine.CAN)
    assert batch.events
    require_equal_lessons(batch, bus)
    assert read_knowledge(tmp_path / "batch", ROBOT, TASK) == read_knowledge(tmp_path / "bus", ROBOT, TASK)


def test_robot_that_leaves_the_batch_is_taught_on_the_bus(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(curriculum, "teach_in_batch", lambda *_given, **_named: None)
    assert lesson(tmp_path / "k", Engine.COMPILED).events == lesson(tmp_path / "bus", Engine.CAN).events


def test_batch_refuses_to_go_on_from_knowledge(tmp_path: Path) -> None:
    lesson(tmp_path / "k", Engine.COMPILED)
    with pytest.raises(BatchRefusedError, match="knowledge to go on from"):
        lesson(tmp_path / "k", Engine.COMPILED)


def test_batch_refuses_another_plan(tmp_path: Path) -> None:
    with pytest.raises(BatchRefusedError, match="a plan of its own"):
        teach(tmp_path / "k", TASK, plan=replace(plan_of(TASK), most_presses=3), engine=Engine.COMPILED)


@pytest.mark.parametrize(
    ("task", "why"),
    [
        (load_task("route"), "metric route"),
        (load_task("wall_following", changes={"learning.doubt.asks": "true"}), "asks at a doubt"),
    ],
)
def test_batch_refuses_lessons_that_it_does_not_know(task: TaskSettings, why: str) -> None:
    with pytest.raises(BatchRefusedError, match=why):
        require_known_lesson(ROBOT, task)
