"""Check of the errors of knowledge: code, place and fields, not words."""

from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError


@contextmanager
def refused(
    code: KnowledgeCode, where: object = None, *, mentions: object = "", **fields: object
) -> Iterator[pytest.ExceptionInfo[KnowledgeError]]:
    """Expect a KnowledgeError of this code, place and fields, whose field `error` names a file or key; yield it.

    Args:
        code: of the error.
        where: its place; None: any.
        mentions: file or key that stands in its field `error`; empty: any.
        fields: some of its fields.
    """
    with pytest.raises(KnowledgeError) as caught:
        yield caught
    error = caught.value
    assert (error.code, {**error.fields, **fields}) == (code, error.fields)
    assert where is None or error.where == str(where)
    assert str(mentions) in str(error.fields.get("error", ""))
    assert "\n" not in str(error)
