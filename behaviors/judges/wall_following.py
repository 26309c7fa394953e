"""Judge of wall following with the wall on one side of the robot."""

from typing import Annotated

from pydantic import Field

from behaviors.judges.common_faults import CommonFaults, Speed, TurnRate, has_fault
from behaviors.judges.judge import AppraisalFeatures, Judge, JudgeSettings, mirrored
from behaviors.policies.sectors import Metres
from simbridge.contracts.simulation import WallSide

Error = Annotated[float, Field(gt=0, le=5)]
"""Difference from the set distance, in metres."""


class WallFollowingSettings(JudgeSettings):
    """Thresholds; distances from the sensors' faces. They are those of a wall on the left."""

    side: WallSide = "left"
    """Side of the robot on which its wall is; right mirrors the thresholds."""
    trouble: CommonFaults
    front_m: Metres
    """Distance ahead below which the robot has to turn right."""
    edge_m: Metres
    """Distance at the front left edge below which the robot has to turn right."""
    near_m: Metres
    """Distance on the left up to which the robot has to turn right."""
    last_m: Metres
    """Distance ahead below which driving on is bad."""
    drives_m_s: Speed
    """Speed above which the robot drives on."""
    drifts_m_s: Speed
    """Speed above which the robot makes way while it turns."""
    spins_m_s: Speed
    """Speed below which a turn above `spins_rad_s` is a spin."""
    spins_rad_s: TurnRate
    away_rad_s: TurnRate
    """Right turn rate above which a necessary turn is good."""
    curves_rad_s: TurnRate
    """Turn rate above which the robot curves to a side."""
    corner_rad_s: TurnRate
    """Turn rate above which the robot curves past the end of the wall."""
    bay_m: Metres
    """Distance at the front right edge below which a left spin is allowed."""
    open_front_m: Metres
    """Distance ahead above which a right spin is bad, together with the three thresholds below."""
    open_edge_m: Metres
    open_left_m: Metres
    open_angle_rad: Annotated[float, Field(ge=-1.6, le=1.6)]
    """Angle away from the wall; a robot whose side sensors tell no angle reads 0, so it takes less than 0."""
    lost_m: Metres
    """Distance above which the left side and the front left edge see no wall."""
    wanted_m: Metres
    """Set distance to the wall on the left."""
    heading_weight_m: Annotated[float, Field(ge=0, le=1)]
    """Distance error in m per radian of heading error."""
    good_m: Error
    """Error below which straight on is good; above it, curving towards less error is."""
    far_m: Error
    """Excess distance above which curving away is bad."""
    close_m: Error
    """Missing distance above which curving to the wall is bad."""
    free_m: Metres
    """Free distance ahead that makes straight on good."""
    free_to_wall_m: Metres
    """Free distance ahead that makes curving to the wall good."""

    def build(self) -> Judge:
        """Return a judge with these thresholds."""
        return WallFollowing(self)


class WallFollowing:
    """Reward +1 for a course along the wall at the set distance or back to it, -1 for leaving or hitting the wall."""

    def __init__(self, settings: WallFollowingSettings) -> None:
        self._settings = settings

    def judge(self, features: AppraisalFeatures) -> int:
        """Return the reward: -1 bad, 0 neutral, +1 good."""
        want, now = self._settings, features if self._settings.side == "left" else mirrored(features)
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
        """Return the reward in a place that demands a right turn."""
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
        """Return the reward at the end of the wall, where a left curve round its corner is good."""
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
