"""The teacher's own drive: the policy decides, with the same minimum time per action."""

from hal.robot import STANDSTILL, SensorReadings
from kurt2rt.core.basic.policy_level import PolicyLevel
from kurt2rt.core.decision.decision import ActiveBehaviour, Decision, DecisionCause
from tests.core.helpers import MINIMUM_TICKS, Counted, sensed, situation


class NearIsB:
    """Says b where the first count is high; for the behaviour `other` the other way round."""

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:
        return "b" if (infrared_counts[0] > 300) != (behaviour == "other") else "a"


FAR, NEAR = sensed(100), sensed(500)


def driven(level: PolicyLevel, readings: SensorReadings, stand_because: DecisionCause | None = None) -> Decision:
    return level.decide(situation(0.0), readings, stand_because)


def test_with_a_reason_to_stand_it_stands_and_begins_anew() -> None:
    actions = {"a": Counted(), "b": Counted()}
    level = PolicyLevel(NearIsB(), actions, MINIMUM_TICKS, ActiveBehaviour())
    driven(level, FAR)
    assert driven(level, FAR, DecisionCause.STOPPED) == Decision(STANDSTILL, DecisionCause.STOPPED, None, None, None)
    assert driven(level, NEAR).action == "b"
    driven(level, FAR, DecisionCause.STOPPED)
    driven(level, NEAR)
    assert (actions["a"].starts, actions["b"].starts) == (1, 2)


def test_policy_level_follows_the_active_behaviour_at_once() -> None:
    wanted = ActiveBehaviour(("one", "other"))
    level = PolicyLevel(NearIsB(), {"a": Counted(), "b": Counted()}, MINIMUM_TICKS, wanted)
    assert driven(level, FAR).action == "a"
    wanted.select("other")
    assert [driven(level, FAR).action for _ in range(2 * MINIMUM_TICKS)] == ["b"] * 2 * MINIMUM_TICKS
    wanted.select("one")
    assert driven(level, FAR).action == "a"
