"""Wall following with the wall on the left: what the scripted teacher of that task praises and blames."""

from typing import Annotated

from pydantic import Field

from behaviors.judges.judge import Circumstances, Judge, JudgeSettings
from behaviors.policies.distances import Distance


class WallFollowingSettings(JudgeSettings):
    """What the teacher looks for; distances from the sensors' faces."""

    wanted_m: Distance
    """Distance to the wall on the left."""
    tolerance_m: Annotated[float, Field(gt=0, le=0.2)]
    """How far from it is still good."""
    angle_rad: Annotated[float, Field(gt=0, le=1.6)]
    """How far from parallel to the wall is still good."""
    free_m: Distance
    """Ahead and to the right at least so much is free where it is good."""
    fast_m_s: Annotated[float, Field(ge=0, le=1)]
    """Slower than this is not good."""
    close_m: Distance
    """Nearer than this to a side is bad."""
    ahead_m: Distance
    """Nearer than this to what is ahead is bad, while it drives on."""
    on_m_s: Annotated[float, Field(ge=0, le=1)]
    """Faster than this it drives on."""

    def build(self) -> Judge:
        """The judge."""
        return WallFollowing(self)


class WallFollowing:
    """Good is on its way along the wall at the wanted distance; bad is what ends in a collision, or gets nowhere."""

    def __init__(self, settings: WallFollowingSettings) -> None:
        self._settings = settings

    def judge(self, circumstances: Circumstances) -> int:
        """-1 bad, 0 neutral, +1 good."""
        want, now = self._settings, circumstances
        if now.bumped or now.no_progress or now.no_wall or min(now.left_m, now.right_m) < want.close_m:
            return -1
        if now.front_m < want.ahead_m and now.speed_m_s > want.on_m_s:
            return -1
        along = abs(now.left_m - want.wanted_m) <= want.tolerance_m and abs(now.left_angle_rad) <= want.angle_rad
        return int(along and min(now.front_m, now.right_m) >= want.free_m and now.speed_m_s >= want.fast_m_s)
