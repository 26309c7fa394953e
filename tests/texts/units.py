"""Listing of the errors of a unit."""

from collections.abc import Iterator
from string import Formatter

from kurt2rt.service.systemd.unit_error import UnitCode, UnitError


def errors() -> Iterator[tuple[str, str]]:
    """Yield the error of each code, with names of its fields for their values."""
    for code in UnitCode:
        names = {name for _, name, _, _ in Formatter().parse(code.what) if name}
        yield code, str(UnitError(code, where="WHERE", **{name: name.upper() for name in names}))
