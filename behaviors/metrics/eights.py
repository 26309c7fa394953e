"""Eights about the two posts of a world: round the western one counter-clockwise, round the eastern one clockwise."""

import random
from collections.abc import Sequence
from itertools import groupby
from operator import le
from typing import Annotated

from pydantic import Field

from behaviors.metrics.angle_about import MEASURE_EVERY, AngleAbout, Mean
from behaviors.metrics.task_metric import DISTANCE_ERROR, Metrics, MetricSettings, TaskMetric
from config.settings import SettingsError
from simbridge.contracts.simulation import Pose, SimulatedPost, Simulation, WorldPlan

_WHOLE = 5 / 6
"""Least fraction of a round that counts as whole; the rest is driven on the other post's side."""


class EightsSettings(MetricSettings):
    """Settings of the metric `eights`: rounds about two posts, and the distance to them."""

    wanted_m: Annotated[float, Field(gt=0, le=5)]
    """Distance from the robot's centre to the face of the nearer post."""

    def require(self, plan: WorldPlan, behaviours: tuple[str, ...]) -> None:  # noqa: ARG002
        """Raise config.settings.SettingsError unless the world has two posts. `behaviours` may be any."""
        if len(plan.posts) != 2:
            raise SettingsError(
                f"metric eights: world {plan.name} has {len(plan.posts)} round obstacles", do="choose one with two"
            )

    def build(self, simulation: Simulation, behaviours: tuple[str, ...], chance: random.Random) -> TaskMetric:  # noqa: ARG002
        """Return the metric in a simulation.

        Raises config.settings.SettingsError unless the world has two posts.
        """
        plan = simulation.plan
        self.require(plan, behaviours)
        west, east = sorted(plan.posts, key=lambda post: post.x_m)
        return Eights(self, west, east, behaviours[0])


class Eights:
    """Metric of eights: half an eight for each round about one post that follows a round about the other.

    A round is what the robot does between coming to a post's side of the floor and leaving it; it must be whole, in the
    wanted direction. Further rounds about the same post count for nothing.
    """

    unit = "eights"
    needs_reset = False

    def __init__(self, settings: EightsSettings, west: SimulatedPost, east: SimulatedPost, behaviour: str) -> None:
        self.behaviour = behaviour
        self.progress = 0.0
        self._wanted_m = settings.wanted_m
        self._posts = (west, east)
        self._sides = (AngleAbout(west.x_m, west.y_m), AngleAbout(east.x_m, east.y_m))
        self._side: int | None = None
        self._rounded: int | None = None
        self._error_m = Mean()
        self._ticks = 0

    @property
    def findings(self) -> Metrics:
        """Distance error in m, by its name."""
        return self._error_m.as_metric(DISTANCE_ERROR)

    def reset(self, pose: Pose) -> None:
        """Break off the round and the eight: the robot was repositioned."""
        self._side = self._rounded = None
        self.update(pose)

    def update(self, pose: Pose) -> None:
        """Add the way round the posts from the pose before, and the distance error; call it in every tick."""
        away_m = [swept.away_m(pose) - post.radius_m for swept, post in zip(self._sides, self._posts, strict=True)]
        side = 0 if away_m[0] <= away_m[1] else 1
        if self._ticks % MEASURE_EVERY == 0:
            self._error_m.add(abs(away_m[side] - self._wanted_m))
        self._ticks += 1
        self._be_on(side)
        self._sides[side].update(pose)

    def update_all(self, poses: Sequence[Pose]) -> None:
        """Update the metric with the poses of ticks in a row, as one call of `update` for each would."""
        west_m, east_m = (
            [each - post.radius_m for each in swept.all_away_m(poses)]
            for swept, post in zip(self._sides, self._posts, strict=True)
        )
        for place in range(-self._ticks % MEASURE_EVERY, len(poses), MEASURE_EVERY):
            away_m = west_m[place] if west_m[place] <= east_m[place] else east_m[place]
            self._error_m.add(abs(away_m - self._wanted_m))
        self._ticks += len(poses)
        place = 0
        for is_west, run in groupby(map(le, west_m, east_m)):
            end, side = place + len(list(run)), 0 if is_west else 1
            self._be_on(side)
            self._sides[side].update_all(poses[place:end])
            place = end

    def abort(self) -> None:
        """Do nothing: progress so far counts."""

    def _be_on(self, side: int) -> None:
        """Begin a round if the robot came to another post's side of the floor."""
        if side != self._side:
            if self._side is not None:
                self._leave(self._side)
            self._side = side
            self._sides[side].interrupt()
            self._sides[side].rounds = 0.0

    def _leave(self, side: int) -> None:
        rounds = self._sides[side].rounds
        if (rounds if side == 0 else -rounds) >= _WHOLE and self._rounded != side:
            self._rounded = side
            self.progress += 0.5
