"""A partner (kurt2rt.bench.partner) that starts at once and has nothing to do: `python -m tests.bench.idler`."""

from typing import Any

import anyio

from kurt2rt.bench.jobs import do_jobs


async def idle() -> dict[str, Any]:
    """Nothing."""
    return {}


if __name__ == "__main__":
    anyio.run(do_jobs, {"idle": idle})
