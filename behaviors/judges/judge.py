"""Contract of judges, and the features they see."""

from abc import abstractmethod
from typing import NamedTuple, Protocol

from config.settings_by_kind import KindSettings


class AppraisalFeatures(NamedTuple):
    """Appraisal situation: distances, motion and faults, computed from the robot's sensor readings alone."""

    left_m: float
    """Nearest object on the left, from the sensors' faces."""
    front_m: float
    right_m: float
    rear_m: float
    ahead_left_m: float
    """Distance seen by the sensors at the front left edge."""
    ahead_right_m: float
    left_angle_rad: float
    """Angle of the robot's nose away from the wall on the left, negative towards it; 0.0 without a wall."""
    right_angle_rad: float
    """Angle of the nose away from the wall on the right."""
    speed_m_s: float
    """Forward positive, smoothed."""
    turn_rad_s: float
    """Counter-clockwise positive, smoothed."""
    bumped: float
    """1.0 shortly after a bumper was pressed, else 0.0."""
    no_progress: float
    """1.0 if the robot drives without getting anywhere, else 0.0."""
    no_wall: float
    """1.0 if no wall has been in view at the sides for long, else 0.0."""
    circling: float = 0.0
    """1.0 if the robot has turned one way for about a round, else 0.0; 0.0 for a critic without this feature."""
    grazing: float = 0.0
    """1.0 shortly after something at a side was very near, else 0.0; 0.0 for a critic without this feature."""
    spun: float = 0.0
    """1.0 during and shortly after a turn on the spot, else 0.0; 0.0 for a critic without this feature."""


def mirrored(features: AppraisalFeatures) -> AppraisalFeatures:
    """Return the features of the same drive in a mirror, for judges that know a wall on the left only."""
    return features._replace(
        left_m=features.right_m,
        right_m=features.left_m,
        ahead_left_m=features.ahead_right_m,
        ahead_right_m=features.ahead_left_m,
        left_angle_rad=features.right_angle_rad,
        right_angle_rad=features.left_angle_rad,
        turn_rad_s=-features.turn_rad_s,
    )


class Judge(Protocol):
    """Reward function of a task: names bad driving (-1) and good driving (+1) from distances and motion.

    Scripted teachers reward by it in phases 3 and 4. It has no memory, because a critic learns from one situation.
    """

    def judge(self, features: AppraisalFeatures) -> int:
        """Return the reward: -1 bad, 0 neutral, +1 good."""
        ...


class JudgeSettings(KindSettings):
    """Base of the settings of every judge; the module's name in this folder is the kind."""

    @abstractmethod
    def build(self) -> Judge:
        """Return a judge with these settings."""
