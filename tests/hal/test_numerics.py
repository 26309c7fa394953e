"""Last bits that depend on the processor are rounded away."""

import hashlib
import math
import os
import struct
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as some

from hal.numerics import cos_sin, power, round_portable
from tests.processors import OF_2004

_ANGLES = range(20_000)


def hash_of_sines() -> str:
    """Return the hash of cosines and sines of many angles."""
    sines = (struct.pack("<2d", *cos_sin(0.0137 * place)) for place in _ANGLES)
    return hashlib.sha256(b"".join(sines)).hexdigest()


@given(some.floats(-1000, 1000))
def test_it_is_rounded_by_less_than_anybody_would_notice(value: float) -> None:
    assert round_portable(value) == pytest.approx(value, abs=2e-10)
    assert round_portable(round_portable(value)) == round_portable(value)


def test_neighbours_become_one_number() -> None:
    for place in range(2000):
        cosine = math.cos(0.0137 * place)
        assert (
            round_portable(math.nextafter(cosine, 2.0))
            == round_portable(cosine)
            == round_portable(math.nextafter(cosine, -2.0))
        )


@given(some.floats(0.5, 1.5), some.integers(-300, 300))
def test_a_power_is_a_power(base: float, exponent: int) -> None:
    assert power(base, exponent) == pytest.approx(base**exponent, rel=1e-12)


def test_cos_sin_is_the_rounded_cosine_and_sine() -> None:
    for place in range(200):
        angle_rad = 0.0137 * place
        assert cos_sin(angle_rad) == (round_portable(math.cos(angle_rad)), round_portable(math.sin(angle_rad)))
    assert cos_sin(0.0) == (1.0, 0.0)


def test_sines_without_fused_multiply_add_are_equal() -> None:
    command = [sys.executable, "-c", "from tests.hal.test_numerics import hash_of_sines as h; print(h())"]
    done = subprocess.run(command, env={**os.environ, **OF_2004}, capture_output=True, text=True, check=True)
    assert done.stdout.split() == [hash_of_sines()]
