"""Fleeing with collision avoidance: what the scripted teacher of that task praises and blames."""

from behaviors.judges.judge import AppraisalFeatures, Judge, JudgeSettings
from behaviors.judges.trouble import CommonFaults, Speed, TurnRate, has_fault
from behaviors.policies.distances import Distance


class FleeingSettings(JudgeSettings):
    """What the teacher looks for; distances from the sensors' faces."""

    trouble: CommonFaults
    front_m: Distance
    """With something ahead nearer than this ..."""
    edge_m: Distance
    """... or ahead to a side nearer than this it has to turn left on the spot."""
    last_m: Distance
    """Nearer than this to what is ahead ..."""
    drives_m_s: Speed
    """... it must not drive on faster than this ..."""
    escapes_rad_s: TurnRate
    """... but where it turns left faster than this."""
    whirls_rad_s: TurnRate
    """Turning left faster than this is right where it has to; where nothing is near, to the right it is wrong."""
    whirls_m_s: Speed
    """Slower than this it turns on the spot."""
    free_front_m: Distance
    """Farther than this from what is ahead ..."""
    free_edge_m: Distance
    """... and from what is ahead to the sides it is free to go."""
    fast_m_s: Speed
    """Faster than this ..."""
    straight_rad_s: TurnRate
    """... and turning slower than this it is off."""
    creeps_m_s: Speed
    """Slower than this ..."""
    curves_rad_s: TurnRate
    """... and turning slower than this it wastes its freedom."""
    wary_m: Distance
    """What is nearer than this ahead to a side it must not curve to."""
    turns_rad_s: TurnRate
    """Turning faster than this it goes to that side."""

    def build(self) -> Judge:
        """The judge."""
        return Fleeing(self)


class Fleeing:
    """Good is to turn left from what is near and to be off where it is free; bad is what drives or turns to things."""

    def __init__(self, settings: FleeingSettings) -> None:
        self._settings = settings

    def judge(self, circumstances: AppraisalFeatures) -> int:
        """-1 bad, 0 neutral, +1 good."""
        want, now = self._settings, circumstances
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
        """It has to turn left on the spot."""
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
        return -1 if now.speed_m_s < want.creeps_m_s and turn_rad_s < want.curves_rad_s else 0

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
