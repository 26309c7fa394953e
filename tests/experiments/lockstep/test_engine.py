"""Exams of a study in a batch, and the choice of witnesses."""

import anyio
import pytest

from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.lockstep import curriculum
from kurt2rt.experiments.lockstep.curriculum import run_drives
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.lockstep.engine import Engine, choose_witnesses
from kurt2rt.experiments.lockstep.exam import ExamSetup
from tests.experiments.helpers import ROBOT, STAGE, examined, short_task


def test_choose_witnesses_takes_one_percent_of_three_to_twenty() -> None:
    assert [len(choose_witnesses(range(drives), "a")) for drives in (0, 2, 20, 300, 301, 3000)] == [0, 2, 3, 3, 4, 20]
    assert [len(choose_witnesses(range(drives), "a", least=1)) for drives in (2, 101)] == [1, 2]


def test_choose_witnesses_depends_on_the_drives_alone() -> None:
    few, many = choose_witnesses(range(100), "a"), choose_witnesses(range(200), "a")
    assert choose_witnesses(list(reversed(range(100))), "a") == few
    assert set(many) & set(range(100)) <= set(few)
    assert choose_witnesses(range(100), "b") != few


def test_robot_that_leaves_the_batch_is_examined_on_the_bus(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(curriculum, "examine_in_batch", lambda *_, **__: [None] * 4)
    # An untaught robot, which stands, and its teacher's policy.
    task, worlds = short_task(exam_s=1.0), ("a", "b")
    assert examined(task, worlds=worlds, engine=Engine.COMPILED) == examined(task, worlds=worlds)


def test_stuck_robot_that_is_rescued_is_examined_on_the_bus() -> None:
    task = load_task("wall_following", changes={"exam.duration_s": "3", "exam.stuck_after_s": "1"})

    def drive(engine: Engine) -> DriveRow:
        async def run() -> list[DriveRow]:
            exam = ExamSetup("a", 1, stuck_ends=False)  # it knows nothing, and stands
            return await run_drives(STAGE, ROBOT, task, [exam], lambda *_: None, engine)

        return anyio.run(run)[0]

    assert drive(Engine.COMPILED) == drive(Engine.CAN)
    assert drive(Engine.CAN).rescues == 2
