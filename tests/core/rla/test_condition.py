"""Conditions in packed form."""

import pickle

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kurt2rt.core.rla.condition import PackedCondition, pack_condition

_NUMBERS = st.lists(st.floats(allow_nan=False), min_size=1, max_size=80).map(tuple)


@given(_NUMBERS)
def test_packed_condition_equals_its_tuple(numbers: tuple[float, ...]) -> None:
    condition = pack_condition(numbers)
    assert isinstance(condition, PackedCondition)
    assert tuple(map(float.hex, condition)) == tuple(map(float.hex, numbers))
    assert np.array(condition).tobytes() == np.array(numbers).tobytes()
    assert (len(condition), condition[0], condition[-1]) == (len(numbers), numbers[0], numbers[-1])
    assert condition[1:] == numbers[1:]
    assert repr(condition) == repr(numbers)
    assert pickle.loads(pickle.dumps(condition)) == condition


@given(_NUMBERS, _NUMBERS)
def test_packed_condition_equal_numbers_are_one_key(a: tuple[float, ...], b: tuple[float, ...]) -> None:
    assert pack_condition(a) == a
    assert a == pack_condition(a)
    assert (pack_condition(a) == pack_condition(b)) == (a == b)
    assert hash(pack_condition(a)) == hash(a)
