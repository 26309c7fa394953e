"""Credits in packed form."""

import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kurt2rt.core.rla.credit import Credit, PackedCredits, pack_credits
from kurt2rt.core.rla.events import RlaRewarded
from kurt2rt.core.rla.rla import Origin, Phase

_CREDITS = st.lists(
    st.builds(Credit, st.integers(1, 2**32 - 1), st.floats(allow_nan=False)), min_size=1, max_size=20
).map(tuple)
_ORIGIN = Origin("c-1", "Ann", Phase.REINFORCEMENT, 0)


@given(_CREDITS, _CREDITS)
def test_packed_credits_equal_their_tuple(a: tuple[Credit, ...], b: tuple[Credit, ...]) -> None:
    credits_ = pack_credits(a)
    assert isinstance(credits_, PackedCredits)
    assert [(rla_id, change.hex()) for rla_id, change in credits_] == [(rla_id, change.hex()) for rla_id, change in a]
    assert (len(credits_), credits_[0], credits_[1:]) == (len(a), a[0], a[1:])
    assert credits_ == a
    assert a == credits_
    assert (credits_ == pack_credits(b)) == (a == b)
    assert (hash(credits_), repr(credits_)) == (hash(a), repr(a))
    assert pickle.loads(pickle.dumps(credits_)) == credits_


@pytest.mark.parametrize("credit", [Credit(0, 1.0), Credit(2**32, 1.0), Credit(True, 1.0), Credit(1, 1)])
def test_pack_credits_unfit_items_are_unchanged(credit: Credit) -> None:
    credits_ = (Credit(1, 1.0), credit)
    assert pack_credits(credits_) is credits_


def test_rla_rewarded_stores_packed_credits() -> None:
    credits_ = tuple(Credit(rla_id, 0.1) for rla_id in range(1, 41))
    rewarded = RlaRewarded(1, 1, 7, _ORIGIN, credits_)
    assert isinstance(rewarded.credits, PackedCredits)
    assert len(rewarded.credits.packed) == 12 * len(credits_)
    assert RlaRewarded(1, 1, 7, _ORIGIN).credits == ()
    assert rewarded == RlaRewarded(1, 1, 7, _ORIGIN, pack_credits(credits_))
