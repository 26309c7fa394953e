"""Way along the walls in laps, with the wall on one side of the robot."""

import random
from collections.abc import Sequence
from typing import Annotated

from pydantic import Field

from behaviors.metrics.angle_about import MEASURE_EVERY, Mean
from behaviors.metrics.task_metric import (
    DISTANCE_ERROR,
    LEAST_SPEED_M_S,
    LeastSpeed,
    Metrics,
    MetricSettings,
    TaskMetric,
)
from simbridge.contracts.simulation import Pose, Position, Simulation, WallSide

_MEASURED_AT_ONCE = 100
"""Positions of one measurement, which takes a tenth of the time of single ones: 10 s of a drive."""


class LapsSettings(MetricSettings):
    """Settings of the metric `laps`: way along walls, in lengths of the outer wall."""

    wanted_m: Annotated[float, Field(gt=0, le=5)]
    """Distance that is wanted from the robot's centre to the nearest wall."""
    least_speed_m_s: LeastSpeed = LEAST_SPEED_M_S
    """Mean speed along walls below which a drive gets nowhere."""
    side: WallSide = "left"
    """Side of the robot on which its wall is."""

    def least_progress(self, simulation: Simulation, duration_s: float) -> float:
        """Return the laps of a drive of `duration_s`, in s, at the least speed."""
        return self.least_speed_m_s * duration_s / simulation.lap_m

    def build(self, simulation: Simulation, behaviours: tuple[str, ...], chance: random.Random) -> TaskMetric:  # noqa: ARG002
        """Return the metric in a simulation. `chance` is not used."""
        if self.side != "left":  # a simulation counts with the wall on the left by itself
            simulation.follow_wall(self.side)
        return Laps(self, simulation, behaviours[0])


class Laps:
    """Metric of laps along walls, and of the mean difference from the wanted distance to the wall, in m."""

    unit = "laps"
    needs_reset = False

    def __init__(self, settings: LapsSettings, simulation: Simulation, behaviour: str) -> None:
        self.behaviour = behaviour
        self._wanted_m = settings.wanted_m
        self._simulation = simulation
        self._error_m = Mean()
        self._unmeasured: list[Position] = []
        """Positions whose distance to the nearest wall is still to be measured."""
        self._ticks = 0

    @property
    def progress(self) -> float:
        """Number of laps; driving backwards is negative."""
        return self._simulation.laps

    @property
    def findings(self) -> Metrics:
        """Distance error in m, by its name."""
        self._measure()
        return self._error_m.as_metric(DISTANCE_ERROR)

    def reset(self, pose: Pose) -> None:
        """Do nothing: the simulation measures the laps."""

    def update(self, pose: Pose) -> None:
        """Add the pose of one tick; every tenth one counts for the distance error."""
        if self._ticks % MEASURE_EVERY == 0:
            self._enter([pose])
        self._ticks += 1

    def update_all(self, poses: Sequence[Pose]) -> None:
        """Add the poses of ticks in a row, as one call of `update` for each would."""
        self._enter(poses[-self._ticks % MEASURE_EVERY :: MEASURE_EVERY])
        self._ticks += len(poses)

    def abort(self) -> None:
        """Do nothing: progress so far counts."""

    def _enter(self, poses: Sequence[Pose]) -> None:
        self._unmeasured += [Position(pose.x_m, pose.y_m) for pose in poses]
        if len(self._unmeasured) >= _MEASURED_AT_ONCE:
            self._measure()

    def _measure(self) -> None:
        for nearest_m in self._simulation.nearest_all_m(self._unmeasured):
            self._error_m.add(abs(nearest_m - self._wanted_m))
        self._unmeasured.clear()
