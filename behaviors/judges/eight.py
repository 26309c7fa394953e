"""An eight round two columns: what the scripted teacher of that task praises and blames."""

from behaviors.judges.judge import AppraisalFeatures, Judge, JudgeSettings
from behaviors.judges.trouble import CommonFaults, Speed, TurnRate, has_fault
from behaviors.policies.distances import Distance


class EightSettings(JudgeSettings):
    """What the teacher looks for; distances from the sensors' faces."""

    trouble: CommonFaults
    front_m: Distance
    """With something ahead nearer than this it has to turn."""
    last_m: Distance
    """Nearer than this to what is ahead it must not drive on."""
    drives_m_s: Speed
    """Faster than this it drives on."""
    away_rad_s: TurnRate
    """Turning faster than this is right where it has to."""
    spins_m_s: Speed
    """Slower than this ..."""
    spins_rad_s: TurnRate
    """... and turning faster than this it spins, which is wrong where it need not turn."""
    lost_m: Distance
    """A column beside it farther than this is not seen."""
    turns_rad_s: TurnRate
    """Turning faster than this away from the only column beside it is wrong ..."""
    edge_m: Distance
    """... where it sees nothing ahead to that side nearer than this."""
    near_m: Distance
    """Farther than this from the column ..."""
    far_m: Distance
    """... and nearer than this ..."""
    round_rad_s: TurnRate
    """... turning to it faster than this ..."""
    round_m_s: Speed
    """... and driving faster than this is good."""
    straight_rad_s: TurnRate
    """Between two columns, turning slower than this is good."""
    unseen_m: Distance
    """With nothing beside it, and nothing nearer than this ahead to the sides, it must not turn right."""

    def build(self) -> Judge:
        """The judge."""
        return Eight(self)


class Eight:
    """Good is round a column at the wanted distance, or between two; bad is away from the only one, or into one."""

    def __init__(self, settings: EightSettings) -> None:
        self._settings = settings

    def judge(self, circumstances: AppraisalFeatures) -> int:
        """-1 bad, 0 neutral, +1 good."""
        want, now = self._settings, circumstances
        if has_fault(now, want.trouble):
            return -1
        if now.front_m < want.front_m:
            drives_at_it = now.front_m < want.last_m and now.speed_m_s > want.drives_m_s
            return -1 if drives_at_it else int(abs(now.turn_rad_s) > want.away_rad_s)
        if abs(now.turn_rad_s) > want.spins_rad_s and now.speed_m_s < want.spins_m_s:
            return -1
        beside_left, beside_right = now.left_m < want.lost_m, now.right_m < want.lost_m
        if beside_left and beside_right:
            return int(now.speed_m_s > want.drives_m_s and abs(now.turn_rad_s) < want.straight_rad_s)
        if beside_left:
            return self._round(now.left_m, now.ahead_left_m, now.turn_rad_s, now.speed_m_s)
        if beside_right:
            return self._round(now.right_m, now.ahead_right_m, -now.turn_rad_s, now.speed_m_s)
        unseen = min(now.ahead_left_m, now.ahead_right_m) > want.unseen_m
        return -1 if unseen and now.turn_rad_s < -want.turns_rad_s else 0

    def _round(self, beside_m: float, ahead_m: float, to_it_rad_s: float, speed_m_s: float) -> int:
        """Round the only column, which is so far beside it; `ahead_m`: what it sees ahead to that side."""
        want = self._settings
        if to_it_rad_s < -want.turns_rad_s and ahead_m > want.edge_m:
            return -1
        right_distance = want.near_m < beside_m < want.far_m
        return int(right_distance and to_it_rad_s > want.round_rad_s and speed_m_s > want.round_m_s)
