"""Listing of the last words of `kurt2rt.service.shutdown`."""

from collections.abc import Iterator

from kurt2rt.service.shutdown import ShutdownStage, timeout_message


def stages() -> Iterator[tuple[str, str]]:
    """Yield the last line of a program that ended without each stage."""
    for stage in ShutdownStage:
        yield stage, timeout_message(stage)
