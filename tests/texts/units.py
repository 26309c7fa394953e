"""Listings of the errors of a unit and of a status that cannot be read."""

from collections.abc import Iterator

from config.errors import TextCode
from kurt2rt.service.health.status_error import StatusCode, StatusError
from kurt2rt.service.systemd.unit_error import UnitCode, UnitError


def errors() -> Iterator[tuple[str, str]]:
    """Yield the error of each code of a unit, with names of its fields for their values."""
    for code in UnitCode:
        yield code, str(UnitError(code, where="WHERE", **_names_of(code)))


def status_errors() -> Iterator[tuple[str, str]]:
    """Yield the error of each code of a status, with names of its fields for their values."""
    for code in StatusCode:
        fields: dict[str, object] = {**_names_of(code)}
        if "silent_s" in fields:
            fields["silent_s"] = 2.5
        yield code, str(StatusError(code, where="WHERE", **fields))


def _names_of(code: TextCode) -> dict[str, str]:
    return {name: name.upper() for name in code.fields}
