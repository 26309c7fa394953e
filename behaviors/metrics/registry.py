"""Registry of the metrics: `laps` is in the file `laps.py` of this folder."""

from typing import Annotated

from pydantic import PlainValidator, SerializeAsAny

from behaviors.metrics.task_metric import MetricSettings
from hal.settings_by_kind import as_its_kind, find_kind

_PACKAGE = "behaviors.metrics"


def metric_settings(kind: str) -> type[MetricSettings]:
    """Return the settings class of a metric. Raises ValueError that lists the kinds."""
    return find_kind(_PACKAGE, kind, MetricSettings)  # type: ignore[type-abstract]


def _checked(given: object) -> MetricSettings:
    return as_its_kind(given, _PACKAGE, MetricSettings)  # type: ignore[type-abstract]


AnyMetricSettings = Annotated[SerializeAsAny[MetricSettings], PlainValidator(_checked)]
"""Settings of the metric that a file names, for a schema."""
