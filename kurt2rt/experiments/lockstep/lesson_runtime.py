"""Runtime of a simulated robot that a scripted teacher teaches, in lockstep with its world."""

from collections.abc import Sequence

from hal.robot_settings import RobotSettings
from hal.simulation import Simulation
from kurt2rt.core.rla.rla import TeachingEvent
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.rla.usage_counter import StatisticsCounter
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.tick import EventStore
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runtime import Runtime, build_runtime


def build_lesson_runtime(
    simulation: Simulation,
    settings: RobotSettings,
    task: TaskSettings,
    keeper: EventStore,
    events: Sequence[TeachingEvent],
    *,
    statistics: StatisticsCounter | None = None,
    saved: Statistics | None = None,
) -> Runtime:
    """Build the runtime for a lesson; `events`, `statistics` and `saved` are those of `build_runtime`.

    Raises as `build_runtime` does.
    """
    # The scripted teacher feels no bumpers: it would give the answer that the robot has. A hand rescues the robot.
    return build_runtime(
        simulation.robot,
        settings,
        task,
        events,
        keeper,
        LockstepClock(simulation.step),
        statistics=statistics,
        checkpoint=saved,
        asks_at_bumper=False,
    )
