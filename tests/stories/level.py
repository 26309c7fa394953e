"""Deciding layer that blocks or fails the tick."""

import math

from hal.robot import SensorReadings, WheelSpeeds
from kurt2rt.core.decision.decision import Decision, DecisionCause, Level
from kurt2rt.core.perception.perception import Situation
from tests.stories.fault import FaultInjection

_TOO_FAST_M_S = 5.0
_TURNS_ROUND_EVERY_S = 0.3


class BrokenTickError(RuntimeError):
    """Tick that ends in a program error."""


class FaultyLevel:
    """Wrapper of the deciding layer (kurt2rt.core.decision.decision.Level).

    off: it raises. stuck: it blocks until the end of the fault. garbage: NaN speeds. wrong: excessive speed with
    reversals, also against a stop. slow: each decision exceeds the age limit. delayed: each decision exceeds a period,
    not the age limit. intermittent: it blocks now and then.
    """

    def __init__(self, injection: FaultInjection) -> None:
        self.inner: Level
        """Deciding layer; set before the first tick."""
        self._injection, self._time = injection, injection.time
        self._hung_at_s = -math.inf

    def decide(self, situation: Situation, readings: SensorReadings, stand_because: DecisionCause | None) -> Decision:
        """Return the inner level's decision, changed by the fault. Raises BrokenTickError for kind off."""
        decision = self.inner.decide(situation, readings, stand_because)
        fault, now_s = self._injection.acting_on("tick"), self._time.now_s()
        if fault is None:
            return decision
        match fault.kind:
            case "off":
                raise BrokenTickError("a behaviour failed")
            case "stuck":
                self._time.run_until(fault.end_s)
            case "garbage":
                return decision._replace(wheel_speeds=WheelSpeeds(math.nan, math.inf))
            case "wrong":
                turns = int((now_s - fault.begin_s) / _TURNS_ROUND_EVERY_S)
                speed_m_s = _TOO_FAST_M_S if turns % 2 == 0 else -_TOO_FAST_M_S
                return _driving(decision)._replace(wheel_speeds=WheelSpeeds(speed_m_s, speed_m_s))
            case "slow" | "delayed":
                self._time.run_until(now_s + fault.delay_s)
            case "intermittent":
                if now_s - self._hung_at_s >= fault.period_s:
                    self._hung_at_s = now_s
                    self._time.run_until(now_s + fault.delay_s)
        return decision


def _driving(decision: Decision) -> Decision:
    """Return the decision of a level that ignores a stop."""
    if decision.driving or decision.match is None:
        return decision
    rla = decision.match.rla
    return decision._replace(cause=DecisionCause.RLA, action=rla.action, rla_id=rla.rla_id)
