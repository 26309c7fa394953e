"""Measure of a task while its simulated robot is taught: laps, rounds, eights, or metres of way."""

import random
from typing import Final

from behaviors.metrics.eights import EightsSettings
from behaviors.metrics.laps import LapsSettings
from behaviors.metrics.rounds import RoundsSettings
from behaviors.metrics.task_metric import MetricSettings, TaskMetric
from behaviors.metrics.way import WaySettings
from hal.settings import SettingsError
from hal.simulation import Simulation
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.system_events import RobotRepositioned
from kurt2rt.core.tick import TickRecord

_MEASURED_LIVE: Final = (LapsSettings, RoundsSettings, EightsSettings)
"""Courses that only watch. Others say which behaviour is wanted next, and here the teacher says so."""
_WAY: Final = WaySettings(kind="way")
_FOLLOW_EVERY: Final = 5
"""Ticks from one look at the pose to the next: 3 cm at 0.6 m/s."""


class LiveMeasure:
    """The course of the task on the robot that is taught, or metres of way where that course measures no such drive."""

    def __init__(self, task: TaskSettings, simulation: Simulation) -> None:
        self._task = task
        self._simulation = simulation
        self._course = self._begin()

    @property
    def progress(self) -> float:
        """Progress of the robot since its run began, in `unit`."""
        return self._course.progress

    @property
    def unit(self) -> str:
        """Unit of `progress`: laps, rounds, eights, m."""
        return self._course.unit

    def on_tick(self, record: TickRecord) -> None:
        """Look at the robot, once in a few ticks; call it after each tick."""
        if any(isinstance(each, RobotRepositioned) for each in record.commands):
            self._course.put(self._simulation.pose)
        # The simulation counts laps by itself, and the distance to the wall is not told.
        elif record.tick % _FOLLOW_EVERY == 0 and not isinstance(self._task.course, LapsSettings):
            self._course.follow(self._simulation.pose)

    def _begin(self) -> TaskMetric:
        course: MetricSettings = self._task.course
        if not isinstance(course, _MEASURED_LIVE):
            course = _WAY
        try:
            return self._built(course)
        except SettingsError:  # such as an eight in a world without two posts
            return self._built(_WAY)

    def _built(self, course: MetricSettings) -> TaskMetric:
        return course.build(self._simulation, self._task.behaviours, random.Random(0))
