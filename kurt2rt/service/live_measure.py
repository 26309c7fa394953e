"""Measure of a task while its simulated robot is taught: laps, rounds, eights, or metres of way."""

import random
from typing import Final

from behaviors.metrics.eights import EightsSettings
from behaviors.metrics.laps import LapsSettings
from behaviors.metrics.rounds import RoundsSettings
from behaviors.metrics.task_metric import MetricSettings, TaskMetric
from behaviors.metrics.way import WaySettings
from config.settings import SettingsError
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.inbox import RobotRepositioned
from kurt2rt.core.tick_record import TickRecord
from simbridge.contracts.simulation import Simulation

_MEASURED_LIVE: Final = (LapsSettings, RoundsSettings, EightsSettings)
"""Metrics that only observe. Other metrics choose the next behaviour, which the teacher does here."""
_WAY: Final = WaySettings(kind="way")
_FOLLOW_EVERY: Final = 5
"""Ticks between two readings of the pose: 3 cm at 0.6 m/s."""


class LiveMeasure:
    """Progress of a simulated robot with its task while it is taught, for the page.

    It is measured by the task's metric, or in m of way if that metric does not only observe.
    """

    def __init__(self, task: TaskSettings, simulation: Simulation) -> None:
        self._task = task
        self._simulation = simulation
        self._metric = self._begin()

    @property
    def progress(self) -> float:
        """Progress since the run began, a count in `unit`."""
        return self._metric.progress

    @property
    def unit(self) -> str:
        """Unit of `progress`: laps, rounds, eights or m."""
        return self._metric.unit

    def on_tick(self, record: TickRecord) -> None:
        """Update the metric every 5 ticks; call it after each tick."""
        if any(isinstance(each, RobotRepositioned) for each in record.commands):
            self._metric.reset(self._simulation.pose)
        # The simulation counts laps itself; the distance to the wall is not needed.
        elif record.tick % _FOLLOW_EVERY == 0 and not isinstance(self._task.metric, LapsSettings):
            self._metric.update(self._simulation.pose)

    def _begin(self) -> TaskMetric:
        metric: MetricSettings = self._task.metric
        if not isinstance(metric, _MEASURED_LIVE):
            metric = _WAY
        try:
            return self._built(metric)
        except SettingsError:  # such as an eight in a world without two posts
            return self._built(_WAY)

    def _built(self, metric: MetricSettings) -> TaskMetric:
        return metric.build(self._simulation, self._task.behaviours, random.Random(0))
