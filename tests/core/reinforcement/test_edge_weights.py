"""Edge weights after rewards."""

import pytest

from kurt2rt.core.reinforcement.edge_weights import EdgeWeights
from kurt2rt.core.reinforcement.eligibility_trace import EligibilityTrace
from kurt2rt.core.reinforcement.rule import CreditUpdate
from kurt2rt.core.reinforcement.settings import ReinforcementSettings
from kurt2rt.core.rla.credit import Credit
from kurt2rt.core.rla.statistics import Statistics

LAST = EligibilityTrace({}, ((3, 4), (2, 3), (1, 2)))


def rule(*way: int | None) -> EdgeWeights:
    """Let the RLAs drive one after the other."""
    learner = EdgeWeights(ReinforcementSettings(rule="edge_weights"))
    for tick, rla_id in enumerate(way):
        learner.update(rla_id, tick)
    return learner


def test_edge_weights_reward_multiplies_or_divides() -> None:
    learner = rule(1, 2, 3, 4)
    learner.learn(1, LAST)
    assert learner.edge_weights == {(3, 4): 90.0, (2, 3): 95.0, (1, 2): 97.0}
    assert learner.value(4) == pytest.approx(0.1)
    learner.learn(-1, LAST)
    learner.learn(-1, LAST)
    assert learner.edge_weights[3, 4] == pytest.approx(100 / 0.9)
    assert learner.value(4) == pytest.approx(1 - 1 / 0.9)
    assert learner.values == {}


def test_edge_weights_value_is_mean_of_used_edges() -> None:
    learner = rule(1, 4, 2, 4, 3, 4)
    assert learner.value(4) == 0.0
    learner.learn(-1, EligibilityTrace({}, ((3, 4),)))
    assert learner.value(4) == pytest.approx(-(100 / 0.9 - 100) / 3 / 100)
    assert learner.value(9) == 0.0


def test_edge_weights_value_stays_within_one() -> None:
    learner = rule(3, 4)
    for _ in range(30):
        learner.learn(-1, EligibilityTrace({}, ((3, 4),)))
    assert learner.value(4) == -1.0


def test_edge_weights_rewards_are_symmetric() -> None:
    learner = rule(3, 4)
    last = EligibilityTrace({}, ((3, 4),))
    hurt = 0
    for _ in range(10_000):
        before = learner.edge_weights
        learner.learn(-1, last)
        hurt += learner.edge_weights != before
    assert learner.edge_weights == {(3, 4): 1000.0}
    healed = 0
    while learner.value(4) < 0.0:
        learner.learn(1, last)
        healed += 1
    assert healed == hurt == 22
    for _ in range(10_000):
        learner.learn(1, last)
    assert learner.edge_weights == {(3, 4): 10.0}
    assert learner.credits_for(1, last) == ()


def test_edge_weights_undo_and_restore_stay_in_bounds() -> None:
    learner = rule()
    learner.restore(Statistics(edge_weights={(3, 4): 1e300, (2, 5): 20.0}))
    assert learner.edge_weights == {(3, 4): 1000.0, (2, 5): 20.0}
    learner.apply_credits([CreditUpdate(Credit(5, 0.5), 0)], 1)
    assert learner.edge_weights[2, 5] == 10.0


def test_edge_weights_standstill_makes_no_edge() -> None:
    assert rule(1, None, 2, 2, 3).edge_weights == {(2, 3): 100.0}


def test_edge_weights_undo_changes_credited_edges_only() -> None:
    learner = rule(1, 2, 3, 4, 2, 4)
    before = learner.edge_weights
    credits_ = learner.credits_for(-1, LAST)
    assert {(credit.before, credit.rla_id) for credit in credits_} == {(1, 2), (2, 3), (3, 4)}
    learner.learn(-1, LAST)
    blamed = learner.edge_weights
    for rla_id, change, edge_from in credits_:
        assert edge_from is not None
        assert blamed[edge_from, rla_id] == pytest.approx(100 - 100 * change)
    learner.learn(1, EligibilityTrace({}, ((2, 4),)))
    bookings = [CreditUpdate(credit, 0) for credit in credits_]
    learner.apply_credits(bookings, -1)
    assert learner.edge_weights == pytest.approx({**before, (2, 4): 90.0})
    learner.apply_credits(bookings, 1)
    assert learner.edge_weights == pytest.approx({**blamed, (2, 4): 90.0})


def test_edge_weights_credits_create_their_edges() -> None:
    learner = rule()
    learner.apply_credits([CreditUpdate(Credit(4, 0.1, 3), 0), CreditUpdate(Credit(4, -0.5, 2), 0)], 1)
    assert learner.edge_weights == pytest.approx({(3, 4): 90.0, (2, 4): 150.0})
    learner.apply_credits([CreditUpdate(Credit(9, 0.1, 3), 0)], -1)
    assert (3, 9) not in learner.edge_weights


def test_edge_weights_old_credits_shift_all_edges() -> None:
    learner = rule(3, 4, 2, 4)
    learner.apply_credits([CreditUpdate(Credit(4, 0.1), 0)], 1)
    assert learner.edge_weights[3, 4] == learner.edge_weights[2, 4] == pytest.approx(90.0)


def test_edge_weights_reset_and_restore_previous() -> None:
    learner = rule(3, 4)
    learner.learn(-1, EligibilityTrace({}, ((3, 4),)))
    worth = learner.value(4)
    learner.reset(4)
    assert (learner.value(4), learner.depth(4)) == (0.0, 1)
    learner.apply_credits([CreditUpdate(Credit(4, worth), 0)], -1)
    learner.restore_previous(4)
    assert (learner.value(4), learner.depth(4)) == pytest.approx((0.0, 0))


def test_edge_weights_restore_continues_saved_weights() -> None:
    learner = rule(1, 2, 3, 4)
    learner.learn(-1, LAST)
    again = rule()
    again.restore(Statistics(edge_weights=dict(learner.edge_weights)))
    assert again.edge_weights == learner.edge_weights
    assert again.value(4) == learner.value(4)
