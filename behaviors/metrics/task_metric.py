"""The contract of a course."""

import random
from abc import abstractmethod
from collections.abc import Mapping
from typing import NamedTuple, Protocol, runtime_checkable

from hal.settings_by_kind import KindSettings
from hal.simulation import Pose, Simulation, WorldPlan

LEAST_SPEED_M_S = 0.1
"""A drive that makes way more slowly than this on average gets nowhere; the shipped policies make 0.2 m/s and more."""

Metrics = Mapping[str, float]
"""Measures by name, with the unit in the name where there is one."""
DISTANCE_ERROR = "distance error, m"
"""Mean size of the difference from the distance that is wanted."""
LATERAL_DEVIATION = "lateral deviation, m"
"""Root of the mean square of the distance from the middle of the street."""
JUNCTIONS = "junctions"
"""How many were asked for, and passed or not got through: stuck, stopped for good or turned back on the way."""
RIGHT = "junctions right"
"""How many of them through the side that was asked for."""


class TaskMetric(Protocol):
    """Watches one drive from above: says what is wanted, and measures how well it is done."""

    @property
    def unit(self) -> str:
        """What progress is counted in, such as `laps`."""
        ...

    @property
    def behaviour(self) -> str:
        """The taught behaviour that is wanted now; empty for tasks with one without a name."""
        ...

    @property
    def needs_reset(self) -> bool:
        """Whether nothing can be done from here: the robot is to be set down elsewhere."""
        ...

    @property
    def progress(self) -> float:
        """How far it came, in units."""
        ...

    @property
    def findings(self) -> Metrics:
        """Other measures of the drive so far; those that nothing was seen of are left out."""
        ...

    def reset(self, pose: Pose) -> None:
        """The robot was set down here by hand, at the start or later."""
        ...

    def update(self, pose: Pose) -> None:
        """Where the robot really is; to be told in every tick."""
        ...

    def abort(self) -> None:
        """The drive ends here before its time, stuck or stopped for good: what is asked now will not be done."""
        ...


class WayAhead(NamedTuple):
    """Where a robot is on a route, as its teacher sees it."""

    passed: int
    """Junctions that it has left behind."""
    inside: bool
    """Whether it is in one."""
    here: str
    """The behaviour that is right at the junction that it is in, or comes to next."""
    after: str
    """The same at the one after it."""


@runtime_checkable
class RouteMetric(TaskMetric, Protocol):
    """A course along a route: what is right at a junction is said to the level that chooses among behaviours."""

    @property
    def ahead(self) -> WayAhead:
        """Where the robot is."""
        ...

    @property
    def reset_pose(self) -> Pose:
        """Where it is to be set down at the start, and where it is needs_reset or makes no way."""
        ...


class MetricSettings(KindSettings):
    """Base of the settings of every course: a class named after its file in this folder, which is the kind."""

    def require(self, plan: WorldPlan, behaviours: tuple[str, ...]) -> None:
        """Look whether a world has what the course needs, for a task that teaches these behaviours.

        Raises hal.settings.SettingsError.
        """

    def least_progress(self, simulation: Simulation, duration_s: float) -> float:  # noqa: ARG002 - for other courses
        """Return the progress up to which a drive of this length, in s, gets nowhere: 0 unless a course knows more."""
        return 0.0

    @abstractmethod
    def build(self, simulation: Simulation, behaviours: tuple[str, ...], chance: random.Random) -> TaskMetric:
        """The course in a simulation. Raises hal.settings.SettingsError as `require` does."""
