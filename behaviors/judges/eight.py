"""Judge of the figure of eight round two columns."""

from behaviors.judges.common_faults import CommonFaults, Speed, TurnRate, has_fault
from behaviors.judges.judge import AppraisalFeatures, Judge, JudgeSettings
from behaviors.policies.sectors import Metres


class EightSettings(JudgeSettings):
    """Thresholds of the judge of the eight; distances in m from the sensors' faces."""

    trouble: CommonFaults
    front_m: Metres
    """Distance ahead below which the robot has to turn."""
    last_m: Metres
    """Distance ahead below which driving on is bad."""
    drives_m_s: Speed
    """Speed above which the robot drives on."""
    away_rad_s: TurnRate
    """Turn rate above which a necessary turn is good."""
    spins_m_s: Speed
    """Speed below which a turn above `spins_rad_s` is a spin, which is bad unless the robot has to turn."""
    spins_rad_s: TurnRate
    lost_m: Metres
    """Distance at the side above which a column counts as not seen."""
    turns_rad_s: TurnRate
    """Turn rate above which turning away from the only column is bad, unless the edge sensor sees it (`edge_m`)."""
    edge_m: Metres
    near_m: Metres
    """Lower bound of the good distance to a column."""
    far_m: Metres
    """Upper bound of the good distance to a column."""
    round_rad_s: TurnRate
    """Turn rate towards the column above which the curve is good."""
    round_m_s: Speed
    """Speed above which the curve is good."""
    grazes_rad_s: TurnRate
    """Turn rate towards a column above which a grazing robot, by the feature grazing, is bad."""
    other_m: Metres
    """Distance of the second column at the side below which a circling robot has to leave the first."""
    straight_rad_s: TurnRate
    """Turn rate below which driving between two columns is good."""
    unseen_m: Metres
    """Distance at both front edges above which a right turn without a column in view is bad, and so are the first
    moments without one, until the feature no_wall is 1."""

    def build(self) -> Judge:
        """Return a judge with these thresholds."""
        return Eight(self)


class Eight:
    """Reward +1 for curves round a column and courses between two, -1 for leaving or hitting one."""

    def __init__(self, settings: EightSettings) -> None:
        self._settings = settings

    def judge(self, features: AppraisalFeatures) -> int:
        """Return the reward: -1 bad, 0 neutral, +1 good."""
        want, now = self._settings, features
        if has_fault(now, want.trouble):
            return -1
        if now.front_m < want.front_m:
            drives_at_it = now.front_m < want.last_m and now.speed_m_s > want.drives_m_s
            return -1 if drives_at_it else int(abs(now.turn_rad_s) > want.away_rad_s)
        if abs(now.turn_rad_s) > want.spins_rad_s and now.speed_m_s < want.spins_m_s:
            return -1
        if now.circling and max(now.left_m, now.right_m) < want.other_m and abs(now.turn_rad_s) > want.round_rad_s:
            return -1
        beside_left, beside_right = now.left_m < want.lost_m, now.right_m < want.lost_m
        if beside_left and beside_right:
            return int(now.speed_m_s > want.drives_m_s and abs(now.turn_rad_s) < want.straight_rad_s)
        if beside_left:
            return self._round(now, now.left_m, now.ahead_left_m, now.turn_rad_s)
        if beside_right:
            return self._round(now, now.right_m, now.ahead_right_m, -now.turn_rad_s)
        unseen = min(now.ahead_left_m, now.ahead_right_m) > want.unseen_m
        just_lost = not now.no_wall and now.front_m > want.unseen_m
        return -1 if unseen and (just_lost or now.turn_rad_s < -want.turns_rad_s) else 0

    def _round(self, now: AppraisalFeatures, beside_m: float, ahead_m: float, to_it_rad_s: float) -> int:
        """Return the reward next to the only column; `ahead_m`: distance at the front edge on that side."""
        want = self._settings
        if to_it_rad_s < -want.turns_rad_s and ahead_m > want.edge_m:
            return -1
        if now.grazing and to_it_rad_s > want.grazes_rad_s:
            return -1
        right_distance = want.near_m < beside_m < want.far_m
        curves = to_it_rad_s > want.round_rad_s and now.speed_m_s > want.round_m_s
        return int(right_distance and curves and not now.circling)
