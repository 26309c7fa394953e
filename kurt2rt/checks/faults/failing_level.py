"""Faulty decision layer that blocks or fails the tick."""

import math

from hal.robot import SensorReadings, WheelSpeeds
from kurt2rt.checks.faults.fault_rig import RigDisturbance, SimulatedTime
from kurt2rt.core.decision.decision import Decision, DecisionCause
from kurt2rt.core.decision.level import Level
from kurt2rt.core.perception.perception import Situation

_TOO_FAST_M_S = 5.0
_TURNS_ROUND_EVERY_S = 0.3


class BrokenTickError(RuntimeError):
    """Tick that ends in a program error."""


class FaultyLevel:
    """Wrapper of the deciding layer (kurt2rt.core.decision.level.Level).

    off: it raises. stuck: it blocks until the end of the fault. garbage: NaN speeds. wrong: excessive speed with
    reversals, also against a stop. slow: each decision exceeds the age limit. delayed: each decision exceeds a period,
    not the age limit. intermittent: it blocks now and then.
    """

    def __init__(self, time: SimulatedTime, disturbance: RigDisturbance) -> None:
        self._time = time
        self._disturbance = disturbance
        self._hung = -1
        self.inner: Level | None = None
        """Deciding layer; set before the first tick."""

    def decide(self, situation: Situation, readings: SensorReadings, stand_because: DecisionCause | None) -> Decision:
        """Return the inner level's decision, changed by the fault. Raises BrokenTickError for kind off."""
        assert self.inner is not None
        decision = self.inner.decide(situation, readings, stand_because)
        disturbance, now_s = self._disturbance, self._time.now_s()
        if not disturbance.acts(now_s):
            return decision
        match disturbance.kind:
            case "off":
                raise BrokenTickError("a behaviour failed")
            case "stuck":
                self._time.run_until(disturbance.end_s)
            case "garbage":
                return decision._replace(wheel_speeds=WheelSpeeds(math.nan, math.inf))
            case "wrong":
                turns = int((now_s - disturbance.begin_s) / _TURNS_ROUND_EVERY_S)
                speed_m_s = _TOO_FAST_M_S if turns % 2 == 0 else -_TOO_FAST_M_S
                return _driving(decision)._replace(wheel_speeds=WheelSpeeds(speed_m_s, speed_m_s))
            case "slow" | "delayed":
                self._time.run_until(now_s + disturbance.delay_s)
            case "intermittent":
                turn = int((now_s - disturbance.begin_s) / disturbance.period_s)
                if turn != self._hung:
                    self._hung = turn
                    self._time.run_until(now_s + disturbance.delay_s)
        return decision


def _driving(decision: Decision) -> Decision:
    """Return the decision of a level that ignores a stop."""
    if decision.driving or decision.match is None:
        return decision
    rla = decision.match.rla
    return decision._replace(cause=DecisionCause.RLA, action=rla.action, rla_id=rla.rla_id)


class SoakLevel:
    """Wrapper of the deciding layer (kurt2rt.core.decision.level.Level) with temporary faults."""

    def __init__(self, time: SimulatedTime) -> None:
        self._time = time
        self._disturbed: FaultyLevel | None = None
        self.inner: Level | None = None
        """Deciding layer; set before the first tick."""

    def disturb(self, disturbance: RigDisturbance) -> None:
        """Let decisions be changed by this fault, until `clear`."""
        self._disturbed = FaultyLevel(self._time, disturbance)
        self._disturbed.inner = self.inner

    def clear(self) -> None:
        """End the fault: decisions are those of the inner level again."""
        self._disturbed = None

    def decide(self, situation: Situation, readings: SensorReadings, stand_because: DecisionCause | None) -> Decision:
        """Return the inner level's decision, changed by the fault if one is active.

        Raises BrokenTickError for kind off.
        """
        level = self._disturbed or self.inner
        assert level is not None
        return level.decide(situation, readings, stand_because)
