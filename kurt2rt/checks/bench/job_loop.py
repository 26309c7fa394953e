"""Job loop of a helper process: one line of JSON per job and per answer."""

import json
import sys
from collections.abc import Awaitable, Callable, Mapping
from typing import Any

import anyio.to_thread

Job = Callable[..., Awaitable[dict[str, Any]]]
"""Function from the fields of a request to those of the answer."""


async def run_jobs(jobs: Mapping[str, Job]) -> None:
    """Run jobs from standard input and answer on standard output until the input ends."""
    while line := await anyio.to_thread.run_sync(sys.stdin.readline):
        request = json.loads(line)
        answer = await jobs[request.pop("job")](**request)
        sys.stdout.write(json.dumps(answer) + "\n")
        sys.stdout.flush()
