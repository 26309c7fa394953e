"""Judges by name: `wall_following` is in the file `wall_following.py` of this folder."""

from typing import Annotated

from pydantic import PlainValidator, SerializeAsAny

from behaviors.judges.judge import JudgeSettings
from hal.settings_by_kind import as_its_kind, find_kind

_PACKAGE = "behaviors.judges"


def judge_settings(kind: str) -> type[JudgeSettings]:
    """Settings of a kind of judge. Raises ValueError that lists the kinds there are."""
    return find_kind(_PACKAGE, kind, JudgeSettings)  # type: ignore[type-abstract]


def _checked(given: object) -> JudgeSettings:
    return as_its_kind(given, _PACKAGE, JudgeSettings)  # type: ignore[type-abstract]


AnyJudgeSettings = Annotated[SerializeAsAny[JudgeSettings], PlainValidator(_checked)]
"""In a schema: settings of whatever judge the file names."""
