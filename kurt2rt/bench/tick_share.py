"""What a tick takes of its period, stage by stage."""

from kurt2rt.bench.real_time import RealTimeRun
from kurt2rt.bench.result import Goal, Reference, Result

MEDIAN_LIMIT_US = 100.0
P99_LIMIT_US = 250.0


def tick_results(run: RealTimeRun, period_s: float) -> tuple[Result, ...]:
    """Each stage of the ticks of a run, and all together beside the period."""
    whole = Result(
        "tick",
        "tick, all stages",
        run.tick,
        Reference("period", period_s * 1e6, run.tick.median_us),
        (
            Goal("median us", run.tick.median_us, MEDIAN_LIMIT_US),
            Goal("p99 us", run.tick.p99_us, P99_LIMIT_US),
        ),
        "at 100 Hz the caches are cold",
    )
    return (*(Result("tick", f"  {stage.name.lower()}", share) for stage, share in run.stages.items()), whole)
