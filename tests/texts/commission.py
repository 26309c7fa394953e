"""Listing of the texts of a commissioning."""

from collections.abc import Iterator

from kurt2rt.checks.commission.fault import FaultCode, Field, SkipCode, StepFault

_VALUES: dict[str, Field] = {
    "bit_rate_bit_s": 1_000_000,
    "junk": "error frames",
    "count": 3,
    "message": "INFO_1",
    "robots": "hardware 7 and hardware 9",
    "frame": "ENCODER (0x09)",
    "period_ms": 20.0,
    "expected_ms": 10.0,
    "took_s": 0.75,
    "most_s": 0.5,
    "drive": "left forward",
    "cause": "the wheels ran away",
    "silent_s": 1.5,
    "mode": "SPEED",
    "ratio": 0.23,
    "ticks": 21938.2,
    "side": "left",
    "motion": "right back",
    "sensors": "s1, s2",
    "sensor": "s5",
    "says": "the readings scatter",
    "least": 4,
    "near_counts": 70.0,
    "near_m": 0.1,
    "far_counts": 69.0,
    "far_m": 0.6,
    "counts": 179.0,
    "least_counts": 250.0,
    "most_counts": 1000.0,
    "distance_m": 0.2,
    "bits": "bit 2",
    "bumper": "front left",
}


def faults() -> Iterator[tuple[str, str]]:
    """Yield the instruction of each fault."""
    for code in FaultCode:
        yield code, StepFault(code, {name: _VALUES[name] for name in code.fields}).text


def skips() -> Iterator[tuple[str, str]]:
    """Yield the reason of each kind of skipped step."""
    for code in SkipCode:
        yield code, code.text
