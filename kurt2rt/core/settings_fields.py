"""Fields that several schemas of settings have, and the fingerprint by which knowledge is bound to some."""

import hashlib
import json
from collections.abc import Mapping
from typing import Annotated

from pydantic import AfterValidator, Field

Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=64)]
Sentence = Annotated[str, Field(pattern=r"^[^\x00-\x1f\x7f]+$", max_length=120)]
Share = Annotated[float, Field(ge=0, le=1)]
Metres = Annotated[float, Field(gt=0, le=10)]


def or_left_out(says: str) -> AfterValidator:
    """Return the check of an optional key that is left out where it does not apply, and refuses null.

    `says`: what to give, and when to leave it out, as the end of a sentence.
    """

    def given(value: object) -> object:
        if value is None:
            raise ValueError(f"give {says}")
        return value

    return AfterValidator(given)


def fingerprint(content: Mapping[str, object]) -> str:
    """Return 16 hexadecimal digits that change with the content, which JSON can hold."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:16]
