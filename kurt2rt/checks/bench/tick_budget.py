"""Results of a real-time run: lateness, and the tick's stages against its period."""

from kurt2rt.checks.bench.real_time import RealTimeRun
from kurt2rt.checks.bench.result import BenchGoal, BenchResult, Reference
from kurt2rt.platform.ledger import Percentiles

MEDIAN_LIMIT_US = 100.0
P99_LIMIT_US = 250.0
TIMES_BETTER = 5.0
"""Required ratio of a bare asyncio.sleep loop's p99 to ours."""


def tick_results(run: RealTimeRun, period_s: float) -> tuple[BenchResult, ...]:
    """Return each stage of a real-time run's ticks, and their sum against the period in s."""
    whole = share_result("tick", "tick, all stages", run.tick, period_s, "at 100 Hz the caches are cold")
    return (*(BenchResult("tick", f"  {stage.name.lower()}", share) for stage, share in run.stages.items()), whole)


def share_result(bench: str, what: str, tick: Percentiles, period_s: float, note: str) -> BenchResult:
    """Return the sum of a tick's stages against the period in s.

    `bench`, `what`: names of the result. `note`: line below the table.
    """
    return BenchResult(
        bench,
        what,
        tick,
        Reference("period", period_s * 1e6, tick.median_us),
        (BenchGoal("median us", tick.median_us, MEDIAN_LIMIT_US), BenchGoal("p99 us", tick.p99_us, P99_LIMIT_US)),
        note,
    )


def lateness_result(run: RealTimeRun) -> BenchResult:
    """Return the lateness of a run's ticks with that of the bare loop."""
    reference = Reference("asyncio.sleep, p99", run.asyncio_lateness.p99_us, run.lateness.p99_us)
    return BenchResult(
        "lateness",
        "tick begins late",
        run.lateness,
        reference,
        (
            BenchGoal("ratio", reference.ratio, TIMES_BETTER, at_least=True),
            BenchGoal("missed", run.missed_ticks, 0),
        ),
        f"{run.ticks} ticks, {run.missed_ticks} missed; {run.rlas} RLAs, "
        f"driving in {run.driving_share:.0%} of the ticks",
    )
