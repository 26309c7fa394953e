"""Errands in a town: the robot is led about and told names of places, and is sent to them later."""

import random
from typing import Annotated

from pydantic import Field

from behaviors.metrics.junctions import QUARTERS, require_streets
from behaviors.metrics.streets import StreetMap
from behaviors.metrics.task_metric import JUNCTIONS, Metrics, MetricSettings, TaskMetric
from behaviors.metrics.town import Street, Town
from simbridge.contracts.simulation import Pose, Simulation, WorldPlan


class ErrandsSettings(MetricSettings):
    """Settings of the metric `errands`: junctions passed, and goals reached by short ways."""

    names: Annotated[int, Field(ge=1, le=1000)]
    """Number of named places without home; goals are among them."""
    goals: Annotated[int, Field(ge=1, le=1000)]
    """Number of goals."""
    junctions_at_least: Annotated[int, Field(ge=1, le=100)]
    """Least number of junctions on the shortest way to a goal."""
    detour_at_most: Annotated[float, Field(ge=1, le=10)]
    """A goal counts as reached by a way of at most so many times the shortest; and no way that it was led from there
    to there in one piece may be that short, else the goal was demonstrated."""

    def require(self, plan: WorldPlan, behaviours: tuple[str, ...]) -> None:
        """Raise config.settings.SettingsError without junctions, or for behaviours that choose no exit."""
        require_streets("errands", plan, behaviours)

    def build(self, simulation: Simulation, behaviours: tuple[str, ...], chance: random.Random) -> TaskMetric:  # noqa: ARG002
        """Return the metric in a simulation. `chance` is not used.

        Raises config.settings.SettingsError if the world has no junctions, or for behaviours that choose no exit.
        """
        return self.walk_in(simulation.plan, behaviours)

    def walk_in(self, plan: WorldPlan, behaviours: tuple[str, ...]) -> "Errands":
        """Return the metric in a world, as a tracker of streets.

        Raises config.settings.SettingsError if the world has no junctions, or for behaviours that choose no exit.
        """
        self.require(plan, behaviours)
        return Errands(Town(StreetMap(plan), {each: QUARTERS[each] for each in behaviours}), behaviours[0])


class Errands:
    """Count of junctions driven through, and the trail of streets that tours and goal exams read."""

    unit = "junctions"
    needs_reset = False

    def __init__(self, town: Town, behaviour: str) -> None:
        self.town = town
        self.behaviour = behaviour
        self.progress = 0.0
        self.street: Street | None = None
        """Street of the robot; None within a junction and off the streets."""
        self.streets: list[Street | None] = []
        """Streets in their order; None before each repositioning."""

    @property
    def findings(self) -> Metrics:
        """Number of junctions that the robot left, under the name of this measure."""
        return {JUNCTIONS: self.progress}

    def reset(self, pose: Pose) -> None:
        """Continue at this pose, after a repositioning too; the way there counts no junction."""
        self.street = self.town.street_at(pose)
        self.streets += [None, self.street]

    def update(self, pose: Pose) -> None:
        """Count a junction if this pose is in the next street; call it in every tick."""
        # From the edge of the junction on: a robot may know that it is in the next street a hand's breadth behind it.
        here = self.town.street_at(pose)
        if here is None:
            self.street = None
        elif self.street is None:
            self.street = here
            self.streets.append(here)
            self.progress += 1

    def abort(self) -> None:
        """Do nothing: junctions so far count."""
