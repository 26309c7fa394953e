"""The contract of a judge, and what it looks at."""

from abc import abstractmethod
from typing import NamedTuple, Protocol

from hal.settings_by_kind import KindSettings


class AppraisalFeatures(NamedTuple):
    """The appraisal situation: how near things are, how the robot moves, and what goes wrong, from its senses alone."""

    left_m: float
    """Nearest thing on the left, from the sensors' faces."""
    front_m: float
    right_m: float
    rear_m: float
    ahead_left_m: float
    """What the sensors see that look ahead to the left."""
    ahead_right_m: float
    left_angle_rad: float
    """How far the nose is turned away from the wall on the left; negative: towards it. 0.0 where there is none."""
    right_angle_rad: float
    """The same for the wall on the right."""
    speed_m_s: float
    """Forward positive, smoothed."""
    turn_rad_s: float
    """Counter-clockwise positive, smoothed."""
    bumped: float
    """1.0 when a bumper was pressed a moment ago, else 0.0."""
    no_progress: float
    """1.0 when the robot drives and gets nowhere, else 0.0."""
    no_wall: float
    """1.0 when it has had no wall beside it for long, else 0.0."""
    surprised: float = 0.0
    """1.0 when something else than expected came a moment ago, else 0.0; 0.0 for a critic that does not look at it."""


class Judge(Protocol):
    """Says what a teacher would think of the circumstances.

    Memoryless, as a reference policy is: a critic can only learn from what is in its appraisal situation.
    """

    def judge(self, circumstances: AppraisalFeatures) -> int:
        """-1 bad, 0 neutral, +1 good."""
        ...


class JudgeSettings(KindSettings):
    """Base of the settings of every judge: a class named after its file in this folder, which is the kind."""

    @abstractmethod
    def build(self) -> Judge:
        """The judge."""
