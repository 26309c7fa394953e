"""Listing of the texts of a unit's access findings."""

from collections.abc import Iterator
from pathlib import Path

from kurt2rt.service.systemd.access import AccessCode, AccessFinding, access_text


def findings() -> Iterator[tuple[str, str]]:
    """Yield the line of each finding, with a blank in the path."""
    for code in AccessCode:
        yield code, access_text(AccessFinding(code, Path("/srv/my robot.yaml"), Path("/srv"), "ann", "kurt2rt"))
