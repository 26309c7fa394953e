"""Protocol of task metrics."""

import random
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import Annotated, NamedTuple, Protocol, runtime_checkable

from pydantic import Field

from config.settings_by_kind import KindSettings
from simbridge.contracts.areas import Borders
from simbridge.contracts.simulation import Pose, Simulation, WorldPlan

LEAST_SPEED_M_S = 0.1
"""A drive that makes way more slowly than this on average gets nowhere; KURT2's policies make 0.2 m/s and more."""
LeastSpeed = Annotated[float, Field(gt=0, le=3)]
"""Such a speed of a slower robot, in m/s."""

Metrics = Mapping[str, float]
"""Measures by name, with the unit in the name where there is one."""
DISTANCE_ERROR = "distance error, m"
"""Mean size of the difference from the distance that is wanted."""
LATERAL_DEVIATION = "lateral deviation, m"
"""Root of the mean square of the distance from the middle of the street."""
JUNCTIONS = "junctions"
"""Number of required junctions: passed, or not got through because the robot was stuck, stopped or turned back."""
RIGHT = "junctions right"
"""Number of junctions left through the required side."""


class TaskMetric(Protocol):
    """Metric of one drive: progress in laps, metres, junctions or turns, and other measures such as distance error.

    Exams call `update` with the true pose in every tick. For some tasks it also says which behaviour is required next.
    """

    @property
    def unit(self) -> str:
        """Unit of the progress, such as `laps`."""
        ...

    @property
    def behaviour(self) -> str:
        """Required behaviour; empty for tasks with one unnamed behaviour."""
        ...

    @property
    def needs_reset(self) -> bool:
        """True if the robot must be repositioned to go on."""
        ...

    @property
    def progress(self) -> float:
        """Progress in `unit`, a count or m."""
        ...

    @property
    def findings(self) -> Metrics:
        """Further measures of the drive so far; measures without values are left out."""
        ...

    def reset(self, pose: Pose) -> None:
        """Start at this pose: call it at the beginning and after each repositioning."""
        ...

    def update(self, pose: Pose) -> None:
        """Update the metric with the true pose, in every tick."""
        ...

    def abort(self) -> None:
        """End the drive early, stuck or stopped: the current requirement counts as missed."""
        ...


@runtime_checkable
class StretchMetric(TaskMetric, Protocol):
    """Metric that can take the poses of many ticks at once, which is faster."""

    def update_all(self, poses: Sequence[Pose]) -> None:
        """Update the metric with the true poses of ticks in a row, as one call of `update` for each would.

        Only in a simulation that follows a batch (simbridge.contracts.batch.FollowedSimulation).
        """
        ...


@runtime_checkable
class BorderMetric(StretchMetric, Protocol):
    """Metric that changes its behaviour, or needs a reset, only in `reset` and where the robot crosses a border."""

    @property
    def borders(self) -> Borders:
        """Borders, which stay where they are."""
        ...


class WayAhead(NamedTuple):
    """Position of a robot on a route, for its teacher."""

    passed: int
    """Number of junctions already left."""
    inside: bool
    """True if the robot is in a junction."""
    here: str
    """The behaviour that is right at the junction that it is in, or comes to next."""
    after: str
    """The same at the one after it."""


@runtime_checkable
class RouteMetric(TaskMetric, Protocol):
    """Metric along a route; its requirements are for the level that chooses behaviours."""

    @property
    def ahead(self) -> WayAhead:
        """Position of the robot on the route."""
        ...

    @property
    def reset_pose(self) -> Pose:
        """Pose at the start, and after a repositioning or rescue."""
        ...


class MetricSettings(KindSettings):
    """Base of the settings of every metric: a class named after its file in this folder, which is the kind."""

    def require(self, plan: WorldPlan, behaviours: tuple[str, ...]) -> None:
        """Check that a world has all that the metric needs, for a task that teaches these behaviours.

        Raises config.settings.SettingsError if it lacks something. This base needs nothing.
        """

    def least_progress(self, simulation: Simulation, duration_s: float) -> float:  # noqa: ARG002 - for other courses
        """Return the progress, in the metric's unit, up to which a drive counts as getting nowhere.

        It is 0 unless a metric overrides this, such as by the distance at 0.1 m/s.

        Args:
            simulation: world of the drive, for metrics that measure by it, such as in laps.
            duration_s: length of the drive in s.
        """
        return 0.0

    @abstractmethod
    def build(self, simulation: Simulation, behaviours: tuple[str, ...], chance: random.Random) -> TaskMetric:
        """Return the metric of one drive in a simulation.

        Raises config.settings.SettingsError if the world lacks something that the metric needs.

        Args:
            simulation: that the robot drives in.
            behaviours: taught behaviours of the task.
            chance: source of random requirements.
        """
