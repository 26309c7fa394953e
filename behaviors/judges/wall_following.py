"""Wall following with the wall on the left: what the scripted teacher of that task praises and blames."""

from typing import Annotated

from pydantic import Field

from behaviors.judges.judge import AppraisalFeatures, Judge, JudgeSettings
from behaviors.judges.trouble import CommonFaults, Speed, TurnRate, has_fault
from behaviors.policies.distances import Distance

Error = Annotated[float, Field(gt=0, le=0.6)]
"""Difference from the wanted distance, in metres."""


class WallFollowingSettings(JudgeSettings):
    """What the teacher looks for; distances from the sensors' faces."""

    trouble: CommonFaults
    front_m: Distance
    """With something ahead nearer than this ..."""
    edge_m: Distance
    """... or ahead to the left nearer than this ..."""
    near_m: Distance
    """... or on the left no farther than this it has to turn right."""
    last_m: Distance
    """Nearer than this to what is ahead it must not drive on."""
    drives_m_s: Speed
    """Faster than this it drives on."""
    drifts_m_s: Speed
    """Faster than this it is on its way, however it turns."""
    spins_m_s: Speed
    """Slower than this ..."""
    spins_rad_s: TurnRate
    """... and turning faster than this it spins."""
    away_rad_s: TurnRate
    """Turning right faster than this is right where it has to."""
    curves_rad_s: TurnRate
    """Turning left or right faster than this it goes to that side."""
    corner_rad_s: TurnRate
    """The same past the end of the wall."""
    bay_m: Distance
    """Only where something ahead to the right is nearer than this may it spin left."""
    open_front_m: Distance
    """Where it is free ahead ..."""
    open_edge_m: Distance
    """... and ahead to the left ..."""
    open_left_m: Distance
    """... and to the left ..."""
    open_angle_rad: Annotated[float, Field(ge=0, le=1.6)]
    """... and its nose looks away from the wall so far, it must not spin right."""
    lost_m: Distance
    """Farther than this to the left and ahead to the left is no wall."""
    wanted_m: Distance
    """Distance to the wall on the left."""
    heading_weight_m: Annotated[float, Field(ge=0, le=1)]
    """Metres of error that one radian of heading error counts for."""
    good_m: Error
    """Less error than this is good straight on; with more, curving to where it gets less is."""
    far_m: Error
    """With more than this too far off it must not curve away."""
    close_m: Error
    """With more than this too close it must not curve to the wall."""
    free_m: Distance
    """Ahead at least so much is free where straight on is good ..."""
    free_to_wall_m: Distance
    """... and so much where it curves to the wall."""

    def build(self) -> Judge:
        """The judge."""
        return WallFollowing(self)


class WallFollowing:
    """Good is along the wall at the wanted distance, or what leads there; bad is what leads away from it or into it."""

    def __init__(self, settings: WallFollowingSettings) -> None:
        self._settings = settings

    def judge(self, circumstances: AppraisalFeatures) -> int:
        """-1 bad, 0 neutral, +1 good."""
        want, now = self._settings, circumstances
        if has_fault(now, want.trouble):
            return -1
        if now.front_m < want.front_m or now.ahead_left_m < want.edge_m or now.left_m <= want.near_m:
            return self._blocked(now)
        if now.no_wall:
            return 0 if now.turn_rad_s >= want.corner_rad_s else -1
        if self._spins_without_need(now):
            return -1
        if now.left_m >= want.lost_m and now.ahead_left_m >= want.lost_m:
            return self._past_the_end(now)
        return self._along(now)

    def _blocked(self, now: AppraisalFeatures) -> int:
        """It has to turn right."""
        want = self._settings
        drives_at_it = now.front_m < want.last_m and now.speed_m_s > want.drives_m_s
        if now.turn_rad_s > want.curves_rad_s or drives_at_it:
            return -1
        return int(now.turn_rad_s < -want.away_rad_s)

    def _spins_without_need(self, now: AppraisalFeatures) -> bool:
        want = self._settings
        if abs(now.turn_rad_s) <= want.spins_rad_s or now.speed_m_s >= want.spins_m_s:
            return False
        if now.turn_rad_s > 0:
            return now.ahead_right_m > want.bay_m
        return (
            now.front_m > want.open_front_m
            and now.ahead_left_m > want.open_edge_m
            and now.left_m > want.open_left_m
            and now.left_angle_rad > want.open_angle_rad
        )

    def _past_the_end(self, now: AppraisalFeatures) -> int:
        """The wall ends: round its corner."""
        want = self._settings
        if now.turn_rad_s > want.corner_rad_s and now.speed_m_s > want.drifts_m_s:
            return 1
        return -1 if now.turn_rad_s < -want.corner_rad_s else 0

    def _along(self, now: AppraisalFeatures) -> int:
        want = self._settings
        error_m = now.left_m - want.wanted_m + want.heading_weight_m * now.left_angle_rad
        to_wall, away = now.turn_rad_s > want.curves_rad_s, now.turn_rad_s < -want.curves_rad_s
        if (error_m > want.far_m and away) or (error_m < -want.close_m and to_wall):
            return -1
        if abs(error_m) < want.good_m:
            return int(now.speed_m_s > want.drives_m_s and now.front_m > want.free_m)
        mends = (to_wall and now.front_m > want.free_to_wall_m) if error_m > 0 else away
        return int(mends and now.speed_m_s > want.drifts_m_s)
