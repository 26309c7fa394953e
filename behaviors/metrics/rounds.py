"""Rounds about the single post of a world."""

import random
from collections.abc import Sequence
from itertools import groupby
from typing import Annotated, Literal

from pydantic import Field

from behaviors.metrics.angle_about import MEASURE_EVERY, AngleAbout, Mean
from behaviors.metrics.task_metric import DISTANCE_ERROR, Metrics, MetricSettings, TaskMetric
from config.settings import SettingsError
from simbridge.contracts.simulation import Pose, SimulatedPost, Simulation, WorldPlan

Distance = Annotated[float, Field(gt=0, le=5)]


class RoundsSettings(MetricSettings):
    """Settings of the metric `rounds`; distances from the robot's center to the face of the post."""

    wanted_m: Distance
    within_m: Distance
    """Farther off the robot is not at the post, and what it does counts for nothing."""
    turning: Literal["left", "right"]
    """Left: counter-clockwise, with the post on the left."""

    def require(self, plan: WorldPlan, behaviours: tuple[str, ...]) -> None:  # noqa: ARG002
        """Raise config.settings.SettingsError unless the world has one post."""
        if len(plan.posts) != 1:
            raise SettingsError(
                f"metric rounds: world {plan.name} has {len(plan.posts)} round obstacles",
                do="choose one with a single one",
            )

    def build(self, simulation: Simulation, behaviours: tuple[str, ...], chance: random.Random) -> TaskMetric:  # noqa: ARG002
        """Return the metric in a simulation. `chance` is not used.

        Raises config.settings.SettingsError unless the world has one post.
        """
        plan = simulation.plan
        self.require(plan, behaviours)
        return Rounds(self, plan.posts[0], behaviours[0])


class Rounds:
    """Metric of rounds about a post, back turns against, and of the mean difference from the wanted distance.

    Only the way near the post counts as progress.
    """

    unit = "rounds"
    needs_reset = False

    def __init__(self, settings: RoundsSettings, post: SimulatedPost, behaviour: str) -> None:
        self.behaviour = behaviour
        self._settings = settings
        self._radius_m = post.radius_m
        self._swept = AngleAbout(post.x_m, post.y_m)
        self._sign = 1.0 if settings.turning == "left" else -1.0
        self._error_m = Mean()
        self._ticks = 0

    @property
    def progress(self) -> float:
        """Count of rounds in the required direction."""
        return self._sign * self._swept.rounds

    @property
    def findings(self) -> Metrics:
        """Distance error in m by its name; poses far from the post are included."""
        return self._error_m.as_metric(DISTANCE_ERROR)

    def reset(self, pose: Pose) -> None:
        """Break off the round: the robot was repositioned."""
        self._swept.interrupt()
        self.update(pose)

    def update(self, pose: Pose) -> None:
        """Add the turn about the post from the pose before, and the distance error; call it in every tick."""
        away_m = self._swept.away_m(pose) - self._radius_m
        if self._ticks % MEASURE_EVERY == 0:
            self._error_m.add(abs(away_m - self._settings.wanted_m))
        self._ticks += 1
        if away_m > self._settings.within_m:
            self._swept.interrupt()
        else:
            self._swept.update(pose)

    def update_all(self, poses: Sequence[Pose]) -> None:
        """Update the metric with the poses of ticks in a row, as one call of `update` for each would."""
        away_m = [each - self._radius_m for each in self._swept.all_away_m(poses)]
        for each in away_m[-self._ticks % MEASURE_EVERY :: MEASURE_EVERY]:
            self._error_m.add(abs(each - self._settings.wanted_m))
        self._ticks += len(poses)
        place = 0
        for is_near, run in groupby(each <= self._settings.within_m for each in away_m):
            end = place + len(list(run))
            if is_near:
                self._swept.update_all(poses[place:end])
            else:
                self._swept.interrupt()
            place = end

    def abort(self) -> None:
        """Do nothing: progress so far counts."""
