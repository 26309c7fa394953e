"""What a benchmark measured, with a reference from the same run and the goals beside it."""

from dataclasses import dataclass

from kurt2rt.platform.ledger import Percentiles


@dataclass(frozen=True, slots=True)
class Reference:
    """What else took how long in the same run: a ratio says more about a program than a time on some machine."""

    what: str
    took_us: float
    result_us: float
    """The median or the p99 of the result, whichever is compared."""

    @property
    def ratio(self) -> float:
        """How many times longer the reference took."""
        return self.took_us / max(self.result_us, 1e-3)


@dataclass(frozen=True, slots=True)
class BenchGoal:
    """One number and the limit it should keep."""

    what: str
    """Names the number and its unit, as in `p99 us`."""
    measured: float
    limit: float
    at_least: bool = False
    """True where more is better."""

    @property
    def met(self) -> bool:
        """Whether the number keeps its limit."""
        return self.measured >= self.limit if self.at_least else self.measured <= self.limit

    def __str__(self) -> str:
        return f"{self.what} {'>=' if self.at_least else '<='} {self.limit:g}"


@dataclass(frozen=True, slots=True)
class BenchResult:
    """One row of the report."""

    bench: str
    what: str
    took: Percentiles
    reference: Reference | None = None
    goals: tuple[BenchGoal, ...] = ()
    note: str = ""
    """What one has to know to read the numbers."""
