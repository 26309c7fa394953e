"""Conditions in packed form."""

import pickle
import sys

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kurt2rt.core.rla.condition import PackedCondition, pack_condition
from kurt2rt.core.rla.rla import Origin, Phase, Rla

_NUMBERS = st.lists(st.floats(allow_nan=False), min_size=1, max_size=80).map(tuple)
_ORIGIN = Origin("c-1", "Ann", Phase.SUPERVISED, 0)


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


def test_packed_condition_zero_equals_minus_zero() -> None:
    assert pack_condition((0.0, 1.0)) == pack_condition((-0.0, 1.0))
    assert hash(pack_condition((0.0, 1.0))) == hash(pack_condition((-0.0, 1.0)))
    assert pack_condition((0.0, 1.0)) != pack_condition((0.0, 1.0, 2.0))
    assert pack_condition((0.0,)) != [0.0]


def test_packed_condition_array_copy_is_writable() -> None:
    condition = pack_condition((1.0, 2.0))
    array = np.array(condition)
    array[0] = 5.0
    assert condition == (1.0, 2.0)
    assert np.array(condition, dtype=np.float32).dtype == np.float32
    assert np.array([condition, condition]).shape == (2, 2)


def test_rla_stores_a_packed_condition() -> None:
    rla = Rla(1, tuple(0.1 * place for place in range(72)), "forward", None, _ORIGIN)
    assert isinstance(rla.condition, PackedCondition)
    assert sys.getsizeof(rla.condition.packed) + sys.getsizeof(rla.condition) < 700
