"""What events have taught."""

from collections.abc import Iterable

from hal.robot_settings import RobotSettings
from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.rla.rla import CRITIC, TeachingEvent
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.space import Space
from kurt2rt.core.task_settings import TaskSettings


def folded(task: TaskSettings, robot: RobotSettings, events: Iterable[TeachingEvent]) -> RlaSystem:
    """The RLA system with all its levels, to look at: it does not match by the task's weights."""
    dimensions = load_situation(task.situation, robot.infrared.names).dimensions
    system = RlaSystem(
        dimensions, task.learning.radius, others={CRITIC: Space(len(load_critic(task.critic).names), 1.0, None)}
    )
    system.apply_all(events)
    return system
