"""Check of one plug-in: all promises of its kind."""

from collections.abc import Callable, Mapping
from contextlib import closing
from typing import Any, cast

from pydantic import TypeAdapter, ValidationError

from behaviors.metrics.task_metric import MetricSettings
from behaviors.primitives import primitive_speeds
from behaviors.registry import JUDGES, METRICS, POLICIES, AnyJudgeSettings, AnyMetricSettings, AnyPolicySettings
from behaviors.repertoire_settings import BEHAVIOURS, ActionSettings, PluginAction, RepertoireSettings
from hal.robot_kind import RobotKind
from hal.robot_plugins import ROBOTS, find_robot_kind
from hal.robot_settings import RobotSettings
from hal.settings import load_settings
from hal.settings_files import TASKS, WORLDS, find_config
from hal.simulation import SimulationFactory
from kurt2rt.checks.plugins.kinds import NoPluginError, Subject
from kurt2rt.checks.plugins.promises import (
    broken_of_action,
    broken_of_judge,
    broken_of_judge_on_robot,
    broken_of_metric,
    broken_of_policy,
)
from kurt2rt.checks.plugins.robot_promises import broken_of_robot
from kurt2rt.core.critic.appraisal_features import AppraisalPerception
from kurt2rt.core.critic.sides import critic_of
from kurt2rt.core.learner.conformance import broken_among, broken_promises
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.lockstep.compatibility import require_course
from kurt2rt.experiments.lockstep.learner_setting import learner_setting
from kurt2rt.experiments.rivals.registry import LEARNERS, find_learner
from kurt2rt.knowledge.task_repertoire import load_task_repertoire

_TASK = "wall_following"
"""Shipped task with whose world, repertoire and situation a part is tried that no task names."""
_SEED, _PURPOSE = 1, "plug-in check"


class PluginCheck:
    """Checks of all kinds, on one robot and its simulation."""

    def __init__(self, robot: RobotSettings, factory: SimulationFactory) -> None:
        """Take the robot, and what opens its simulations."""
        self._robot = robot
        self._factory = factory
        self._checks: Mapping[str, Callable[[str], list[str]]] = {
            LEARNERS.group: self._of_learner,
            POLICIES.group: self._of_policy,
            JUDGES.group: lambda name: broken_of_judge(_settings(AnyJudgeSettings, name)),
            METRICS.group: self._of_metric,
            BEHAVIOURS.group: self._of_action,
            TASKS.group: self._of_task,
            WORLDS.group: self._of_world,
            ROBOTS.group: lambda name: broken_of_robot(cast("RobotKind", find_robot_kind(name)), name),
        }

    def broken_promises(self, subject: Subject) -> list[str]:
        """Return the promises that a plug-in breaks, each in a sentence; empty if it keeps all that were tried.

        Raises UserError if the plug-in cannot be loaded, so that nothing can be tried.
        """
        return self._checks[subject.group](subject.name)

    def _of_learner(self, name: str) -> list[str]:
        return broken_promises(find_learner(name), learner_setting(load_task(_TASK), self._robot, seed=_SEED))

    def _of_policy(self, name: str) -> list[str]:
        settings = _settings(AnyPolicySettings, name)
        actions = load_task_repertoire(load_task(_TASK), self._robot)
        return broken_of_policy(settings, self._robot, actions, settings.behaviours or ("",))

    def _of_metric(self, name: str) -> list[str]:
        task = load_task(_TASK)
        return self._metric_in(_settings(AnyMetricSettings, name), task.teaching.world, task.behaviours)

    def _metric_in(self, settings: MetricSettings, world: str, behaviours: tuple[str, ...]) -> list[str]:
        with closing(self._factory.open(world, _SEED, _PURPOSE)) as simulation:
            return broken_of_metric(settings, simulation, behaviours)

    def _of_action(self, name: str) -> list[str]:
        settings = _settings(ActionSettings, name, name="tried")
        if not isinstance(settings, PluginAction):
            raise NoPluginError("is a shipped kind of action", where=name, do="give a plug-in")
        return broken_of_action(settings, self._robot)

    def _of_task(self, name: str) -> list[str]:
        robot, task = self._robot, load_task(name)
        worlds = (task.teaching.world, *task.exam.worlds)
        self._factory.require_worlds(*worlds)
        require_course(self._factory, task, worlds)
        load_situation(task.situation, robot.infrared.names)
        actions = load_task_repertoire(task, robot)
        entries = load_settings(find_config("repertoires", task.repertoire), RepertoireSettings).actions
        broken = {
            "policy": broken_of_policy(task.policy, robot, actions, task.behaviours),
            "judge": self._of_judge_in(task),
            "course": self._metric_in(task.course, task.teaching.world, task.behaviours),
        }
        actions_of_plugins = (each for each in entries if isinstance(each, PluginAction))
        broken |= {f"action {each.name}": broken_of_action(each, robot) for each in actions_of_plugins}
        return [f"{part}: {line}" for part, lines in broken.items() for line in lines]

    def _of_judge_in(self, task: TaskSettings) -> list[str]:
        AppraisalPerception(critic_of(task.critic, self._robot), self._robot)  # refuses sensors that the robot lacks
        if task.judge is None:
            return []
        on_robot = broken_of_judge_on_robot(task.judge, task.policy, self._robot, primitive_speeds(task.repertoire))
        return broken_of_judge(task.judge) + on_robot

    def _of_world(self, name: str) -> list[str]:
        self._factory.require_worlds(name)
        return broken_among(
            (("it is the same each time", lambda: self._factory.settings_of(name) == self._factory.settings_of(name)),)
        )


def _settings(schema: Any, kind: str, **more: str) -> Any:
    """Return the settings of a kind with their defaults. Raises NoPluginError."""
    try:
        return TypeAdapter(schema).validate_python({"kind": kind, **more})
    except ValidationError as error:
        problem = error.errors(include_url=False)[0]
        if problem["type"] != "missing":
            raise NoPluginError(problem["msg"], where=kind) from error
        raise NoPluginError(
            f"its setting {problem['loc'][-1]} has no default",
            where=kind,
            do="give it one, or check the file of a task that names it: kurt2rt plugin check TASK.yaml",
        ) from error
