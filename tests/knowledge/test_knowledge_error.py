"""Errors of knowledge: codes and fields, also from another process."""

import pickle
from pathlib import Path

import pytest

from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError, ReconnectRequiredError


@pytest.mark.parametrize("kind", [KnowledgeError, ReconnectRequiredError])
def test_knowledge_error_survives_another_process(kind: type[KnowledgeError]) -> None:
    error = kind(KnowledgeCode.NOT_SAVED, where=Path("a.knowledge"), error=OSError(28, "No space left"))
    again = pickle.loads(pickle.dumps(error))
    assert (type(again), again.code, again.where, again.fields) == (kind, error.code, "a.knowledge", error.fields)
    assert str(again) == str(error)
