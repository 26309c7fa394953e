"""Listing of the texts of missing answers."""

from collections.abc import Iterator

from kurt2rt.teacher.client.answer import NoAnswer, NoAnswerError


def texts() -> Iterator[tuple[str, str]]:
    """Yield code and text of each kind of a missing answer."""
    for code in NoAnswer:
        error = NoAnswerError("a detail", code, trouble="The robot is not found", after_s=3.5, path="/hello")
        yield code.value, str(error)
