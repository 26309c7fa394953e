"""The policy of the streets at the mouth of a crossing that it enters askew."""

import math
from contextlib import closing

import anyio
import pytest

from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.lockstep.exam import ExamRun, ExamSetup
from simbridge.contracts.simulation import Pose
from tests.experiments.helpers import ROBOT, STAGE

CROSSING_X_M, MOUTH_Y_M, BEHIND_Y_M = 2.2, 1.85, 2.6
"""Crossing of two streets in the world Manhattan; its near and far side on the way north."""
OFF = {"behaviours": ("straight_on",)}


def drives_through(pose: Pose, **policy: float | None) -> bool:
    """Return whether the policy drives straight on through the crossing within 5 s, without touching a block."""
    task = load_task("streets", changes={"exam.duration_s": "5"})
    changed = task.policy.model_copy(update=policy)
    task = task.model_copy(update={**OFF, "policy": changed})
    with closing(STAGE.open("manhattan", 1, "exam")) as simulation:
        exam = ExamRun(simulation, ROBOT, task, ExamSetup("manhattan", 1, teacher_policy=True), lambda _done_s: None)
        exam.place(pose)
        anyio.run(exam.drive)
        here = simulation.pose
        return simulation.collisions == 0 and here.y_m > BEHIND_Y_M and abs(here.x_m - CROSSING_X_M) < 0.4


@pytest.mark.parametrize("askew_deg", [-24, 12])
def test_policy_askew_in_a_crossing_drives_through(askew_deg: float) -> None:
    assert drives_through(Pose(CROSSING_X_M, MOUTH_Y_M, math.radians(90 + askew_deg)))
