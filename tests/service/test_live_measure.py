"""The measure of a task while its robot is taught."""

import math
from typing import Any, cast

import pytest

from kurt2rt.core.task_settings import load_task
from kurt2rt.core.teaching.inbox import RobotRepositioned
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.service.live_measure import LiveMeasure
from simbridge.contracts.simulation import Pose, SimulatedPost, WorldPlan

NOTHING = cast(Any, None)
A_RECORD = TickRecord(0, 0.0, NOTHING, NOTHING, NOTHING, NOTHING, ())
POST = SimulatedPost("post", 2.0, 2.0, 0.1)


class FromAbove:
    """Part of a simulation that a live measure reads."""

    def __init__(self, *posts: SimulatedPost) -> None:
        self.pose = Pose(2.5, 2.0, 0.0)
        self.laps = 0.0
        self.plan = WorldPlan(0, "yard", (4.0, 4.0), (), (), posts)


class Drive:
    """A measure that is shown one tick after the other."""

    def __init__(self, task: str, *posts: SimulatedPost) -> None:
        self.simulation = FromAbove(*posts)
        self.measure = LiveMeasure(load_task(task), cast(Any, self.simulation))
        self._tick = 0

    def go(self, x_m: float, y_m: float, *happened: RobotRepositioned) -> None:
        """Keep the robot there as long as a measure needs to see it."""
        self.simulation.pose = Pose(x_m, y_m, 0.0)
        for happening in (happened, *((),) * 4):
            self._tick += 1
            record = A_RECORD._replace(tick=self._tick, commands=happening)
            self.measure.on_tick(record)


def test_live_measure_ignores_a_repositioned_robot() -> None:
    drive = Drive("circle", POST)
    for step in range(41):
        angle = step * math.pi / 10
        drive.go(2.0 + 0.5 * math.cos(angle), 2.0 + 0.5 * math.sin(angle))
    assert drive.measure.unit == "rounds"
    assert drive.measure.progress == pytest.approx(2.0, abs=0.01)
    drive.go(1.5, 2.0, RobotRepositioned())
    drive.go(2.5, 2.0, RobotRepositioned())
    assert drive.measure.progress == pytest.approx(2.0, abs=0.01)


@pytest.mark.parametrize("task", ["eight", "streets", "fleeing"])
def test_live_measure_without_live_metric_counts_metres(task: str) -> None:
    drive = Drive(task)
    drive.go(2.5, 2.0)
    drive.go(2.5, 2.3)
    drive.go(2.1, 2.3)
    drive.go(0.5, 0.5, RobotRepositioned())
    assert drive.measure.unit == "m"
    assert drive.measure.progress == pytest.approx(0.7)
