"""The school robot follows a wall on its right: policy and laps of one task agree on the side."""

from contextlib import closing

import anyio
import pytest

from hal.robot_settings import load_robot
from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.lockstep.exam import ExamSetup, examine
from simbridge.contracts.robot_kind import simulations_of

SCHOOL = load_robot("school")


def laps_of_policy(policy_side: str, laps_side: str) -> float:
    changes = {"policy.side": policy_side, "metric.side": laps_side, "exam.duration_s": "30"}
    task = load_task("school/wall_following", changes=changes)
    with closing(simulations_of(SCHOOL).open("school/a", 1, "exam")) as simulation:
        setup = ExamSetup("school/a", 1, teacher_policy=True)
        result = anyio.run(examine, simulation, SCHOOL, task, setup, lambda _: None)
    assert result.collisions == 0
    return float(result.progress)


def test_policy_of_the_right_wall_makes_laps_on_the_right() -> None:
    laps = laps_of_policy("right", "right")
    assert laps > 0.3
    assert laps_of_policy("right", "left") == pytest.approx(-laps, abs=0.02)
