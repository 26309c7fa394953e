"""Faults that every judge punishes."""

from typing import Annotated

from pydantic import Field

from behaviors.judges.judge import AppraisalFeatures
from config.settings import Settings

Speed = Annotated[float, Field(ge=0, le=1)]
"""Speed in m/s."""
TurnRate = Annotated[float, Field(ge=0, le=4)]
"""Turn rate in rad/s, to either side."""


class CommonFaults(Settings):
    """Thresholds of faults that every judge punishes, such as creeping and backing."""

    creeps_m_s: Speed
    """Speed below which lack of progress counts as a fault."""
    backs_m_s: Speed
    """Backward speed above which the robot is punished: it sees least to the rear."""
    stands_m_s: Speed
    """Speed below which the robot stands, together with `stands_rad_s`."""
    stands_rad_s: TurnRate
    may_turn_rad_s: TurnRate = 4.0
    """Turn rate above which lack of progress is no fault until the robot is circling, by the feature circling."""


def has_fault(now: AppraisalFeatures, trouble: CommonFaults) -> bool:
    """Return whether the robot bumped into something, makes no progress, backs or stands, by these thresholds."""
    return (
        now.bumped > 0.0
        or (now.no_progress > 0.0 and now.speed_m_s < trouble.creeps_m_s and not _turns_out(now, trouble))
        or now.speed_m_s < -trouble.backs_m_s
        or (abs(now.speed_m_s) < trouble.stands_m_s and abs(now.turn_rad_s) < trouble.stands_rad_s)
    )


def _turns_out(now: AppraisalFeatures, trouble: CommonFaults) -> bool:
    """Return whether the robot turns on the spot and has not come round yet."""
    return not now.circling and abs(now.turn_rad_s) > trouble.may_turn_rad_s
