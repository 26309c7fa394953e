"""What any teacher blames, whatever the task."""

from typing import Annotated

from pydantic import Field

from behaviors.judges.judge import AppraisalFeatures
from hal.settings import Settings

Speed = Annotated[float, Field(ge=0, le=1)]
"""In the settings of a judge, in m/s."""
TurnRate = Annotated[float, Field(ge=0, le=4)]
"""The same in rad/s, to either side."""


class CommonFaults(Settings):
    """What is trouble."""

    creeps_m_s: Speed
    """No progress is one only while it drives slower than this."""
    backs_m_s: Speed
    """Backwards faster than this is wrong: there it sees least."""
    stands_m_s: Speed
    """Slower than this ..."""
    stands_rad_s: TurnRate
    """... and turning slower than this it stands."""


def has_fault(now: AppraisalFeatures, trouble: CommonFaults) -> bool:
    """Whether it bumped into something, gets nowhere, backs or stands."""
    return (
        now.bumped > 0.0
        or (now.no_progress > 0.0 and now.speed_m_s < trouble.creeps_m_s)
        or now.speed_m_s < -trouble.backs_m_s
        or (abs(now.speed_m_s) < trouble.stands_m_s and abs(now.turn_rad_s) < trouble.stands_rad_s)
    )
