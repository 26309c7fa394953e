"""Policies by name: `wall_following` is in the file `wall_following.py` of this folder."""

from typing import Annotated

from pydantic import PlainValidator, SerializeAsAny

from behaviors.policies.policy import PolicySettings
from hal.settings_by_kind import as_its_kind, find_kind

_PACKAGE = "behaviors.policies"


def policy_settings(kind: str) -> type[PolicySettings]:
    """Settings of a kind of policy. Raises ValueError that lists the kinds there are."""
    return find_kind(_PACKAGE, kind, PolicySettings)  # type: ignore[type-abstract]


def _checked(given: object) -> PolicySettings:
    return as_its_kind(given, _PACKAGE, PolicySettings)  # type: ignore[type-abstract]


AnyPolicySettings = Annotated[SerializeAsAny[PolicySettings], PlainValidator(_checked)]
"""In a schema: settings of whatever policy the file names."""
