"""Checks of JSON values from a foreign file: of the right type, and such that a knowledge file can hold them."""

import math

_HIGHEST = 2**63 - 1


def require_text(value: object) -> str:
    """Return the value if it is a text that UTF-8 can encode. Raises ValueError."""
    if not isinstance(value, str):
        raise ValueError(f"{_shown(value)} stands where a text should")  # noqa: TRY004 - all problems are of one type
    value.encode()  # half a surrogate pair is fine for JSON alone; UnicodeEncodeError is a ValueError
    return value


def require_int(value: object, least: int = 0) -> int:
    """Return the value if it is a whole number from `least` that fits into 63 bits. Raises ValueError."""
    if not isinstance(value, int) or isinstance(value, bool) or not least <= value <= _HIGHEST:
        raise ValueError(f"{_shown(value)} stands where a whole number from {least} should")
    return value


def require_number(value: object) -> float:
    """Return the value as a dimensionless number, which may be infinite. Raises ValueError, also for NaN."""
    try:
        number = math.nan if not isinstance(value, (int, float)) or isinstance(value, bool) else float(value)
    except OverflowError:
        number = math.nan
    if math.isnan(number):
        raise ValueError(f"{_shown(value)} stands where a number should")
    return number


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 40 else f"{text[:37]}..."
