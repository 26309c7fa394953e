"""An eight round two columns: what the scripted teacher of that task praises and blames."""

from typing import Annotated

from pydantic import Field

from behaviors.judges.judge import Circumstances, Judge, JudgeSettings
from behaviors.policies.distances import Distance


class EightSettings(JudgeSettings):
    """What the teacher looks for; distances from the sensors' faces."""

    close_m: Distance
    """Nearer than this to a column beside it is bad."""
    ahead_m: Distance
    """Nearer than this to what is ahead is bad, while it drives on."""
    on_m_s: Annotated[float, Field(ge=0, le=1)]
    """Faster than this it drives on."""
    near_m: Distance
    """Good is a column beside it farther than this ..."""
    far_m: Distance
    """... and nearer than this ..."""
    turn_rad_s: Annotated[float, Field(ge=0, le=3)]
    """... while it turns to that side at least so fast."""
    fast_m_s: Annotated[float, Field(ge=0, le=1)]
    """Slower than this is not good."""

    def build(self) -> Judge:
        """The judge."""
        return Eight(self)


class Eight:
    """Good is round the nearer column at the wanted distance; bad is too near, far from both for long, or nowhere."""

    def __init__(self, settings: EightSettings) -> None:
        self._settings = settings

    def judge(self, circumstances: Circumstances) -> int:
        """-1 bad, 0 neutral, +1 good."""
        want, now = self._settings, circumstances
        nearest_m = min(now.left_m, now.right_m)
        if now.bumped or now.no_progress or now.no_wall or nearest_m < want.close_m:
            return -1
        if now.front_m < want.ahead_m and now.speed_m_s > want.on_m_s:
            return -1
        to_it = now.turn_rad_s if now.left_m <= now.right_m else -now.turn_rad_s
        return int(
            want.near_m <= nearest_m <= want.far_m and to_it >= want.turn_rad_s and now.speed_m_s >= want.fast_m_s
        )
