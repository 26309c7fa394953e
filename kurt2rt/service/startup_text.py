"""Texts of the program's start for its log, its service manager and `kurt2rt status`."""

from collections.abc import Sequence

from kurt2rt.service.missing_dependency import DependencyName, MissingDependency

_STARTS = "starts"
_WAITS = "stands and waits for {missing}"
_AVAILABLE = "{name} is there"
_MISSING = "{name}: {says}"


def available_text(name: DependencyName) -> str:
    """Return the line for a dependency that is there now."""
    return _AVAILABLE.format(name=name)


def startup_text(missing: Sequence[MissingDependency]) -> str:
    """Return the line for a start with these missing dependencies; those without a known reason are left out."""
    known = [each for each in missing if each.reason is not None]
    return _WAITS.format(missing=missing_text(known)) if known else _STARTS


def missing_text(missing: Sequence[MissingDependency]) -> str:
    """Return the dependencies with a known reason in a line; without any, the names of all."""
    known = [_MISSING.format(name=each.name, says=each.says) for each in missing if each.reason is not None]
    return "; ".join(known or [each.name for each in missing])
