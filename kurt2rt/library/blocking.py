"""Async functions for callers without an event loop, and for callers within one (Jupyter)."""

from collections.abc import Awaitable, Callable
from typing import TypeVar

from anyio.from_thread import start_blocking_portal

ResultT = TypeVar("ResultT")


def run_blocking(call: Callable[[], Awaitable[ResultT]]) -> ResultT:
    """Run an async function to its end in a thread with an event loop of its own, and return its result.

    `asyncio.run` fails where a loop runs already, as in Jupyter.
    """
    with start_blocking_portal() as portal:
        return portal.call(call)
