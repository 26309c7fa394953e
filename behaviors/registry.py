"""Registry of judges, metrics and policies: the kind `wall_following` is the module of that name in their folder.

A kind without a module there is a plug-in (config.plugins).
"""

from typing import Annotated, NoReturn

from pydantic import ConfigDict, PlainValidator, SerializeAsAny

from behaviors.judges.judge import JudgeSettings
from behaviors.metrics.task_metric import MetricSettings
from behaviors.policies.policy import PolicySettings
from config.plugins import PluginKind
from config.settings import SettingsError
from config.settings_by_kind import KindSettings, as_its_kind, is_settings_class, shipped_kinds


def _plugin_kind(folder: str, what: str, base: type[KindSettings]) -> PluginKind:
    return PluginKind(
        folder,
        what,
        f"a subclass of {base.__name__} ({base.__module__})",
        lambda found: is_settings_class(found, base),
        lambda: shipped_kinds(f"behaviors.{folder}", base),
    )


POLICIES = _plugin_kind("policies", "policy", PolicySettings)
JUDGES = _plugin_kind("judges", "judge", JudgeSettings)
METRICS = _plugin_kind("metrics", "metric", MetricSettings)


class _Absent(KindSettings):
    """Settings of a plug-in that is not here, with all their keys; a replay needs none of policy, judge and metric."""

    def build(self, *_: object, **__: object) -> NoReturn:
        """Raise SettingsError."""
        raise SettingsError(
            "belongs to a recording or package, and its plug-in is not installed here",
            where=f"kind {self.kind}",
            do="install it",
        )


_ANY_KEYS = ConfigDict(extra="allow")


class _AbsentPolicy(_Absent, PolicySettings):
    model_config = _ANY_KEYS


class _AbsentJudge(_Absent, JudgeSettings):
    model_config = _ANY_KEYS


class _AbsentMetric(_Absent, MetricSettings):
    model_config = _ANY_KEYS


def _checked_judge(given: object) -> JudgeSettings:
    return as_its_kind(given, "behaviors.judges", JudgeSettings, JUDGES, _AbsentJudge)  # type: ignore[type-abstract]


def _checked_metric(given: object) -> MetricSettings:
    return as_its_kind(given, "behaviors.metrics", MetricSettings, METRICS, _AbsentMetric)  # type: ignore[type-abstract]


def _checked_policy(given: object) -> PolicySettings:
    return as_its_kind(given, "behaviors.policies", PolicySettings, POLICIES, _AbsentPolicy)  # type: ignore[type-abstract]


AnyJudgeSettings = Annotated[SerializeAsAny[JudgeSettings], PlainValidator(_checked_judge)]
"""Schema type: settings of the judge that the file names."""
AnyMetricSettings = Annotated[SerializeAsAny[MetricSettings], PlainValidator(_checked_metric)]
"""Schema type: settings of the metric that the file names."""
AnyPolicySettings = Annotated[SerializeAsAny[PolicySettings], PlainValidator(_checked_policy)]
"""Schema type: settings of the policy that the file names."""
