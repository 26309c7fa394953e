"""Guided tours of a robot that a person teaches."""

from contextlib import closing
from pathlib import Path

import anyio

from kurt2rt.core.task_settings import load_task, taught_by
from kurt2rt.core.teacher_settings import load_teacher
from kurt2rt.experiments.lockstep.lesson_keeping import lessons_kept
from kurt2rt.experiments.navigation.guided_tour import guided_tour
from tests.experiments.helpers import ROBOT, STAGE


def test_guided_tour_counts_the_holds_of_a_person_as_corrections(tmp_path: Path) -> None:
    task = taught_by(load_task("errands", changes={"teaching.corrections_s": "30"}), load_teacher("ordinary"))

    async def lead() -> int:
        with (
            lessons_kept(tmp_path / "town.knowledge", ROBOT, task) as keeping,
            closing(STAGE.open("manhattan", 1, "errands")) as simulation,
        ):
            led = await guided_tour(simulation, ROBOT, task, keeping.training, seed=1, on_progress=lambda _done_s: None)
            return led.corrections

    assert anyio.run(lead) > 0
