"""Result of a benchmark with a reference from the same run and its goals."""

from dataclasses import dataclass

from kurt2rt.platform.ledger import Percentiles


@dataclass(frozen=True, slots=True)
class Reference:
    """Time of a reference in the same run; the ratio is less dependent on the machine than a time."""

    what: str
    took_us: float
    result_us: float
    """Compared median or p99 of the result."""

    @property
    def ratio(self) -> float:
        """Ratio of the reference's time to the measured time."""
        return self.took_us / max(self.result_us, 1e-3)


@dataclass(frozen=True, slots=True)
class BenchGoal:
    """Measured number and its limit."""

    what: str
    """Name of the number with its unit, as in `p99 us`."""
    measured: float
    limit: float
    at_least: bool = False
    """True if larger is better."""

    @property
    def met(self) -> bool:
        """Return whether the number keeps its limit."""
        return self.measured >= self.limit if self.at_least else self.measured <= self.limit

    def __str__(self) -> str:
        return f"{self.what} {'>=' if self.at_least else '<='} {self.limit:g}"


@dataclass(frozen=True, slots=True)
class BenchResult:
    """Row of the report."""

    bench: str
    what: str
    took: Percentiles
    reference: Reference | None = None
    goals: tuple[BenchGoal, ...] = ()
    note: str = ""
    """Remark for the reader of the numbers."""
