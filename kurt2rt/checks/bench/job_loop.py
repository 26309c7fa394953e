"""What a process beside the robot's does for a benchmark: one job after another, each a line of JSON."""

import json
import sys
from collections.abc import Awaitable, Callable, Mapping
from typing import Any

import anyio.to_thread

Job = Callable[..., Awaitable[dict[str, Any]]]
"""Gets the fields of the request, and returns those of the answer."""


async def run_jobs(jobs: Mapping[str, Job]) -> None:
    """Take jobs from standard input and answer each on standard output, until the input ends."""
    while line := await anyio.to_thread.run_sync(sys.stdin.readline):
        request = json.loads(line)
        answer = await jobs[request.pop("job")](**request)
        sys.stdout.write(json.dumps(answer) + "\n")
        sys.stdout.flush()
