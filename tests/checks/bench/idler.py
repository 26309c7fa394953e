"""Helper process that starts at once and has nothing to do: `python -m tests.checks.bench.idler`."""

from typing import Any

import anyio

from kurt2rt.checks.bench.job_loop import run_jobs


async def idle() -> dict[str, Any]:
    """Return an empty answer."""
    return {}


if __name__ == "__main__":
    anyio.run(run_jobs, {"idle": idle})
