"""Compatibility of tasks and worlds."""

from collections.abc import Iterable

from behaviors.metrics.route import RouteSettings
from behaviors.metrics.task_metric import RouteMetric, TaskMetric
from config.settings import SettingsError
from hal.robot_settings import RobotSettings
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.knowledge.task_repertoire import load_task_repertoire
from simbridge.contracts.simulation import SimulationFactory


def require_metric(factory: SimulationFactory, task: TaskSettings, worlds: Iterable[str]) -> None:
    """Check, before any training, that each of these worlds has all that the task's metric needs.

    Raises config.settings.SettingsError that names task, metric and world.
    """
    for world in dict.fromkeys(worlds):
        try:
            task.metric.require(factory.plan_of(world), task.behaviours)
        except SettingsError as error:
            raise SettingsError(str(error), where=f"task {task.name}") from error


def require_actions(task: TaskSettings, robot: RobotSettings) -> None:
    """Check, before any training, that the repertoire has the actions that the policy chooses among.

    Raises config.settings.SettingsError that names the task and the missing actions.
    """
    repertoire = load_task_repertoire(task, robot)
    missing = [name for name in task.policy.required_actions if name not in repertoire]
    if missing:
        raise SettingsError(
            f"the policy {task.policy.kind} may say {', '.join(missing)}, which repertoire {task.repertoire} lacks",
            where=f"task {task.name}",
            do=f"add to its actions, which are {', '.join(repertoire)}",
        )


def route_of(metric: TaskMetric, task: TaskSettings) -> RouteMetric:
    """Return the metric as a route metric. Raises config.settings.SettingsError for another metric."""
    if isinstance(metric, RouteMetric):
        return metric
    raise SettingsError(
        f"metric {task.metric.kind} has no route to teach the mid level",
        where=f"task {task.name}",
        do="give the metric route, or leave mid out",
    )


def route_of_task(task: TaskSettings) -> RouteSettings:
    """Return the settings of a task's route. Raises config.settings.SettingsError for a task without one."""
    if isinstance(task.metric, RouteSettings):
        return task.metric
    raise SettingsError(f"its metric is {task.metric.kind}, and there is no route to teach", where=f"task {task.name}")


def with_route(task: TaskSettings, seed: int, decisions: int | None = None) -> TaskSettings:
    """Return the task with the route of this robot, unless it names one; `decisions`: None: the task's number.

    Raises config.settings.SettingsError for a task that teaches no route.
    """
    metric = route_of_task(task)
    update: dict[str, object] = {"seed": seed if metric.seed is None else metric.seed}
    if decisions is not None:
        update["decisions"] = decisions
    return task.model_copy(update={"metric": metric.model_copy(update=update)})


def with_own_route(task: TaskSettings, seed: int) -> TaskSettings:
    """Return the task, with the route of this robot if it teaches one and names none."""
    own = isinstance(task.metric, RouteSettings) and task.metric.seed is None
    return with_route(task, seed) if own else task
