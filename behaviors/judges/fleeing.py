"""Judge of fleeing with collision avoidance."""

from behaviors.judges.common_faults import CommonFaults, Speed, TurnRate, has_fault
from behaviors.judges.judge import AppraisalFeatures, Judge, JudgeSettings
from behaviors.policies.sectors import Metres


class FleeingSettings(JudgeSettings):
    """Thresholds of the judge of fleeing; distances in m from the sensors' faces."""

    trouble: CommonFaults
    front_m: Metres
    """Distance ahead below which the robot has to spin left."""
    edge_m: Metres
    """Distance at a front edge below which the robot has to spin left."""
    last_m: Metres
    """Distance ahead below which driving faster than `drives_m_s` is bad, unless it turns left by `escapes_rad_s`."""
    drives_m_s: Speed
    escapes_rad_s: TurnRate
    whirls_rad_s: TurnRate
    """Turn rate of a spin: good to the left where necessary, bad to the right in the open."""
    whirls_m_s: Speed
    """Speed below which a turn is a spin."""
    free_front_m: Metres
    """Distance ahead above which the robot is in the open, together with `free_edge_m`."""
    free_edge_m: Metres
    fast_m_s: Speed
    """Speed above which a straight course is good."""
    straight_rad_s: TurnRate
    """Turn rate below which a course is straight."""
    creeps_m_s: Speed
    """Speed below which the robot wastes the open space, together with `curves_rad_s`, unless it has just spun."""
    curves_rad_s: TurnRate
    wary_m: Metres
    """Distance at a front edge below which curving to that side is bad."""
    turns_rad_s: TurnRate
    """Turn rate above which the robot turns to a side."""

    def build(self) -> Judge:
        """Return a judge with these thresholds."""
        return Fleeing(self)


class Fleeing:
    """Reward +1 for left spins at obstacles and fast courses in the open, -1 for approaching things."""

    def __init__(self, settings: FleeingSettings) -> None:
        self._settings = settings

    def judge(self, features: AppraisalFeatures) -> int:
        """Return the reward: -1 bad, 0 neutral, +1 good."""
        want, now = self._settings, features
        if has_fault(now, want.trouble):
            return -1
        edge_m = min(now.ahead_left_m, now.ahead_right_m)
        if now.front_m < want.front_m or edge_m < want.edge_m:
            return self._near(now)
        if now.front_m > want.free_front_m and edge_m > want.free_edge_m:
            return self._free(now)
        if self._is_off(now):
            return 1
        return -1 if self._curves_to_what_it_sees(now) else 0

    def _near(self, now: AppraisalFeatures) -> int:
        """Return the reward in a place that demands a left spin."""
        want = self._settings
        drives_at_it = now.front_m < want.last_m and now.speed_m_s > want.drives_m_s
        if (drives_at_it and now.turn_rad_s < want.escapes_rad_s) or now.turn_rad_s < -want.turns_rad_s:
            return -1
        return int(now.turn_rad_s > want.whirls_rad_s)

    def _free(self, now: AppraisalFeatures) -> int:
        want, turn_rad_s = self._settings, abs(now.turn_rad_s)
        if turn_rad_s > want.whirls_rad_s and now.speed_m_s < want.whirls_m_s:
            return -1 if now.turn_rad_s < 0 else 0
        if self._is_off(now):
            return 1
        # After a turn on the spot the wheels have to speed up first.
        return -1 if now.speed_m_s < want.creeps_m_s and turn_rad_s < want.curves_rad_s and not now.spun else 0

    def _is_off(self, now: AppraisalFeatures) -> bool:
        want = self._settings
        return now.speed_m_s > want.fast_m_s and abs(now.turn_rad_s) < want.straight_rad_s

    def _curves_to_what_it_sees(self, now: AppraisalFeatures) -> bool:
        want = self._settings
        if now.ahead_right_m < min(now.ahead_left_m, want.wary_m):
            return now.turn_rad_s < -want.turns_rad_s
        return (
            now.ahead_left_m < min(now.ahead_right_m, want.wary_m)
            and want.turns_rad_s < now.turn_rad_s < want.whirls_rad_s
        )
