"""Types of the fields that several schemas of settings have."""

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
