"""Listing of the texts of the program's start."""

from collections.abc import Iterator

from kurt2rt.service.startup import DependencyName, missing_text, startup_text


def lines() -> Iterator[tuple[str, str]]:
    """Yield the lines of each dependency, and of a start before and after its first check."""
    for name in DependencyName:
        yield f"{name} missing", startup_text({name: "the error"})
    unchecked = dict.fromkeys(DependencyName, "")
    yield "nothing checked", startup_text(unchecked)
    yield "names of all", missing_text(unchecked)
