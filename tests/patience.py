"""Guard against a test that hangs: no test expects an event within a time of its own."""

from collections.abc import Callable

import anyio

PATIENCE_S = 120.0
"""Seconds after which an event that a test waits for never comes, on a machine however busy."""


async def eventually(holds: Callable[[], object]) -> None:
    """Wait for a condition that sets no event."""
    with anyio.fail_after(PATIENCE_S):
        while not holds():  # noqa: ASYNC110
            await anyio.sleep(0.005)
