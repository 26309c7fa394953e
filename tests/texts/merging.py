"""Listing of the texts of `kurt2rt knowledge merge`."""

from collections.abc import Iterator

from kurt2rt.cli.knowledge.merge import reason_of
from kurt2rt.knowledge.versions.merge import Conflict, ConflictCode


def conflicts() -> Iterator[tuple[str, str]]:
    """Yield the reason of each conflict."""
    for code in ConflictCode:
        yield code, reason_of(Conflict("RLA 4 says left", "RLA 4 says right", code, 2.0, 0.2))
