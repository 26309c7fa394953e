"""Fleeing with collision avoidance: what the scripted teacher of that task praises and blames."""

from typing import Annotated

from pydantic import Field

from behaviors.judges.judge import Circumstances, Judge, JudgeSettings
from behaviors.policies.distances import Distance


class FleeingSettings(JudgeSettings):
    """What the teacher looks for; distances from the sensors' faces."""

    close_m: Distance
    """Nearer than this to a side is bad."""
    ahead_m: Distance
    """Nearer than this to what is ahead is bad, while it drives on."""
    on_m_s: Annotated[float, Field(ge=0, le=1)]
    """Faster than this it drives on."""
    free_m: Distance
    """Ahead at least so much is free where it is good."""
    fast_m_s: Annotated[float, Field(ge=0, le=1)]
    """Slower than this is not good."""

    def build(self) -> Judge:
        """The judge."""
        return Fleeing(self)


class Fleeing:
    """Good is fast into the open; bad is what ends in a collision, or gets nowhere."""

    def __init__(self, settings: FleeingSettings) -> None:
        self._settings = settings

    def judge(self, circumstances: Circumstances) -> int:
        """-1 bad, 0 neutral, +1 good."""
        want, now = self._settings, circumstances
        if now.bumped or now.no_progress or min(now.left_m, now.right_m) < want.close_m:
            return -1
        if now.front_m < want.ahead_m and now.speed_m_s > want.on_m_s:
            return -1
        return int(now.front_m >= want.free_m and now.speed_m_s >= want.fast_m_s)
