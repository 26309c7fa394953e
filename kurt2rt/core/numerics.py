"""Numbers that come out the same on every processor, so that a run which one has recorded another one can replay.

Sums, products, quotients and square roots do by themselves, as long as they are done in the same order. Of sines,
exponentials and their like the C library has several versions, for processors with and without fused multiply-add,
whose last bits differ in one result of some thousand; in a recorded distance that would be another number.
"""

import math

_GRID = 2.0**32


def round_portable(value: float) -> float:
    """A value of some thousand at most, rounded to 2e-10: what a last bit could change is rounded away."""
    return math.floor(value * _GRID + 0.5) / _GRID


def power(base: float, exponent: int) -> float:
    """A whole power by multiplication alone: where a small result must keep its digits."""
    if exponent < 0:
        return 1.0 / power(base, -exponent)
    result = 1.0
    while exponent:
        if exponent & 1:
            result *= base
        base *= base
        exponent >>= 1
    return result
