"""Courses by name: `laps` is in the file `laps.py` of this folder."""

from typing import Annotated

from pydantic import PlainValidator, SerializeAsAny

from behaviors.metrics.task_metric import MetricSettings
from hal.settings_by_kind import as_its_kind, find_kind

_PACKAGE = "behaviors.metrics"


def metric_settings(kind: str) -> type[MetricSettings]:
    """Settings of a kind of course. Raises ValueError that lists the kinds there are."""
    return find_kind(_PACKAGE, kind, MetricSettings)  # type: ignore[type-abstract]


def _checked(given: object) -> MetricSettings:
    return as_its_kind(given, _PACKAGE, MetricSettings)  # type: ignore[type-abstract]


AnyMetricSettings = Annotated[SerializeAsAny[MetricSettings], PlainValidator(_checked)]
"""In a schema: settings of whatever course the file names."""
