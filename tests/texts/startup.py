"""Listing of the texts of the program's start."""

from collections.abc import Iterator

from kurt2rt.service.missing_dependency import DependencyName, MissingDependency, WaitReason
from kurt2rt.service.startup import available_text, missing_text, startup_text


def lines() -> Iterator[tuple[str, str]]:
    """Yield the lines of each dependency, and of a start before and after its first check."""
    for name in DependencyName:
        yield f"{name} available", available_text(name)
        yield f"{name} missing", startup_text([MissingDependency(name, WaitReason.SYSTEM, "the error")])
    unchecked = [MissingDependency(name) for name in DependencyName]
    yield "nothing checked", startup_text(unchecked)
    yield "names of all", missing_text(unchecked)
