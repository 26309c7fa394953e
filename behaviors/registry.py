"""Registry of judges and policies: the kind `wall_following` is the module of that name in their folder."""

from typing import Annotated

from pydantic import PlainValidator, SerializeAsAny

from behaviors.judges.judge import JudgeSettings
from behaviors.policies.policy import PolicySettings
from hal.settings_by_kind import as_its_kind, find_kind

_JUDGES, _POLICIES = "behaviors.judges", "behaviors.policies"


def judge_settings(kind: str) -> type[JudgeSettings]:
    """Return the settings class of a kind of judge. Raises ValueError that lists the kinds."""
    return find_kind(_JUDGES, kind, JudgeSettings)  # type: ignore[type-abstract]


def policy_settings(kind: str) -> type[PolicySettings]:
    """Return the settings class of a kind of policy. Raises ValueError that lists the kinds."""
    return find_kind(_POLICIES, kind, PolicySettings)  # type: ignore[type-abstract]


def _checked_judge(given: object) -> JudgeSettings:
    return as_its_kind(given, _JUDGES, JudgeSettings)  # type: ignore[type-abstract]


def _checked_policy(given: object) -> PolicySettings:
    return as_its_kind(given, _POLICIES, PolicySettings)  # type: ignore[type-abstract]


AnyJudgeSettings = Annotated[SerializeAsAny[JudgeSettings], PlainValidator(_checked_judge)]
"""Schema type: settings of the judge that the file names."""
AnyPolicySettings = Annotated[SerializeAsAny[PolicySettings], PlainValidator(_checked_policy)]
"""Schema type: settings of the policy that the file names."""
