"""State of an episode after a decision, as the environment shows it."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from behaviors.judges.judge import AppraisalFeatures
from hal.guard_reason import GuardReason
from kurt2rt.gym.endings import Ending
from simbridge.contracts.simulation import Pose


class Moment(NamedTuple):
    """State of an episode after a decision, from which the environment makes observation, reward and info."""

    situation: NDArray[np.float64]
    """Recent features, then their averages if they are observed, in the units of the situation; shape (d,)."""
    counts: tuple[int, ...]
    """Readings that the robot decides by, in counts."""
    features: AppraisalFeatures | None
    """Critic's features; None while the robot is blind, and possibly if they are not needed."""
    action: str
    """Action that drives; empty while the robot stands for another reason."""
    guard: tuple[GuardReason, ...]
    """Reasons why the guard changed the wheel speeds."""
    pose: Pose
    collisions: int
    progress: float
    """Progress by the task's metric, in its unit."""
    ticks: int
    """Ticks since the start."""
    ending: Ending | None
    """Reason that the episode is over; None while it goes on."""


class AgentDrive(Protocol):
    """Drive of one episode by an agent, decision by decision, in a batch or over the CAN bus."""

    @property
    def world(self) -> str:
        """Name or path of the world."""
        ...

    @property
    def moment(self) -> Moment:
        """State after the newest tick."""
        ...

    @property
    def trail(self) -> list[Pose]:
        """Way so far, a point every 0.1 s, in m."""
        ...

    def drive(self, action: str, ticks: int) -> Moment:
        """Drive by an action for `ticks` ticks, or until the episode is over; return the state then.

        Raises KeyError for an action outside the repertoire.
        """
        ...

    def close(self) -> None:
        """Stop the robot and free its simulation."""
        ...
