"""How late ticks begin."""

from kurt2rt.checks.bench.real_time import RealTimeRun
from kurt2rt.checks.bench.result import BenchGoal, BenchResult, Reference

TIMES_BETTER = 5.0
"""The p99 is at most a fifth of what a bare asyncio.sleep loop reaches."""


def lateness_result(run: RealTimeRun) -> BenchResult:
    """Lateness of the ticks of a run beside that of the bare loop in the same run."""
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
