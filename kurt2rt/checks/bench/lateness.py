"""Result of the lateness benchmark."""

from kurt2rt.checks.bench.real_time import RealTimeRun
from kurt2rt.checks.bench.result import BenchGoal, BenchResult, Reference

TIMES_BETTER = 5.0
"""Required ratio of a bare asyncio.sleep loop's p99 to ours."""


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
