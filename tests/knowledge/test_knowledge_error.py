"""Errors of knowledge: codes and fields, also from another process."""

import pickle
import sqlite3
from pathlib import Path

import pytest

from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError, ReconnectRequiredError, from_sqlite


@pytest.mark.parametrize("kind", [KnowledgeError, ReconnectRequiredError])
def test_knowledge_error_survives_another_process(kind: type[KnowledgeError]) -> None:
    error = kind(KnowledgeCode.NOT_SAVED, where=Path("a.knowledge"), error=OSError(28, "No space left"))
    again = pickle.loads(pickle.dumps(error))
    assert (type(again), again.code, again.where, again.fields) == (kind, error.code, "a.knowledge", error.fields)
    assert str(again) == str(error)


@pytest.mark.parametrize(
    ("number", "code"),
    [
        (sqlite3.SQLITE_IOERR_FSYNC, KnowledgeCode.DISK_FAILS),
        (sqlite3.SQLITE_PROTOCOL, KnowledgeCode.LOCKS_STUCK),
        (sqlite3.SQLITE_MISUSE, KnowledgeCode.SQLITE_REFUSES),
        (None, KnowledgeCode.SQLITE_REFUSES),
    ],
)
def test_from_sqlite_number_selects_the_code(number: int | None, code: KnowledgeCode) -> None:
    cause = sqlite3.OperationalError("of SQLite")
    if number is not None:
        cause.sqlite_errorcode = number
    error = from_sqlite(cause, Path("a.knowledge"))
    assert (error.code, error.fields) == (code, {"error": "of SQLite"})
    assert isinstance(error, ReconnectRequiredError) == (number == sqlite3.SQLITE_PROTOCOL)
