"""Listings of the errors of knowledge."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from kurt2rt.knowledge.journal.binding import require_compatible
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from tests.knowledge.lessons import BINDING


def knowledge_errors() -> Iterator[tuple[str, str]]:
    """Yield the error of each code, with names of its fields for their values."""
    for code in KnowledgeCode:
        fields = {name: name.upper() for name in code.fields}
        yield code, str(KnowledgeError(code, where="mine.knowledge", **fields))


def differences() -> Iterator[tuple[str, str]]:
    """Yield the differences of a file's features from those of a robot."""
    names = BINDING.feature_names
    for label, others in {
        "one of each": (*names[:-1], "a"),
        "only the file's": names[:-1],
        "only the robot's": (*names, *"abcdef"),
        "other order": names[::-1],
        "other definition": names,
    }.items():
        wanted = replace(BINDING, feature_hash="another", feature_names=others)
        try:
            require_compatible(BINDING, wanted, Path("mine.knowledge"), lambda _: True)
        except KnowledgeError as error:
            yield label, str(error.fields["difference"])
