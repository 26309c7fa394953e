"""Functions with equal results on every processor, so that a run recorded on one can be replayed on another.

Sums, products, quotients and square roots are equal if their order is. The C library has several versions of sines and
exponentials, with and without fused multiply-add: one result in some thousand differs in its last bits.
"""

import math

_GRID = 2.0**32


def round_portable(value: float) -> float:
    """Return a dimensionless number below about 4000, rounded to 2e-10, which removes differences of last bits."""
    return math.floor(value * _GRID + 0.5) / _GRID


def cos_sin(angle_rad: float) -> tuple[float, float]:
    """Return cosine and sine of an angle in rad as `round_portable` rounds them; the batch compiles this, too."""
    return (
        math.floor(math.cos(angle_rad) * _GRID + 0.5) / _GRID,
        math.floor(math.sin(angle_rad) * _GRID + 0.5) / _GRID,
    )


def power(base: float, exponent: int) -> float:
    """Return a dimensionless number to a whole power by multiplication alone; small results keep their digits."""
    if exponent < 0:
        return 1.0 / power(base, -exponent)
    result = 1.0
    while exponent:
        if exponent & 1:
            result *= base
        base *= base
        exponent >>= 1
    return result
