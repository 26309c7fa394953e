"""Registry of judges, metrics and policies: the kind `wall_following` is the module of that name in their folder."""

from typing import Annotated

from pydantic import PlainValidator, SerializeAsAny

from behaviors.judges.judge import JudgeSettings
from behaviors.metrics.task_metric import MetricSettings
from behaviors.policies.policy import PolicySettings
from hal.settings_by_kind import as_its_kind


def _checked_judge(given: object) -> JudgeSettings:
    return as_its_kind(given, "behaviors.judges", JudgeSettings)  # type: ignore[type-abstract]


def _checked_metric(given: object) -> MetricSettings:
    return as_its_kind(given, "behaviors.metrics", MetricSettings)  # type: ignore[type-abstract]


def _checked_policy(given: object) -> PolicySettings:
    return as_its_kind(given, "behaviors.policies", PolicySettings)  # type: ignore[type-abstract]


AnyJudgeSettings = Annotated[SerializeAsAny[JudgeSettings], PlainValidator(_checked_judge)]
"""Schema type: settings of the judge that the file names."""
AnyMetricSettings = Annotated[SerializeAsAny[MetricSettings], PlainValidator(_checked_metric)]
"""Schema type: settings of the metric that the file names."""
AnyPolicySettings = Annotated[SerializeAsAny[PolicySettings], PlainValidator(_checked_policy)]
"""Schema type: settings of the policy that the file names."""
