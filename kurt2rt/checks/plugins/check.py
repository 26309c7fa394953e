"""Check of one plug-in: all promises of its kind."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from typing import Any, NamedTuple, cast

from pydantic import TypeAdapter, ValidationError

from behaviors.metrics.task_metric import MetricSettings
from behaviors.primitives import primitive_speeds
from behaviors.registry import JUDGES, METRICS, POLICIES, AnyJudgeSettings, AnyMetricSettings, AnyPolicySettings
from behaviors.repertoire_settings import BEHAVIOURS, ActionSettings, PluginAction, RepertoireSettings
from hal.robot_kind import RobotKind, simulations_of
from hal.robot_plugins import ROBOTS, find_robot_kind, find_task_of_robot
from hal.robot_settings import DEFAULT_KIND, RobotSettings, load_robot
from hal.settings import load_settings
from hal.settings_files import TASKS, WORLDS, find_config
from hal.simulation import SimulationFactory
from kurt2rt.checks.plugins.kinds import NoPluginError, Subject
from kurt2rt.checks.plugins.learner_check import Finding, check_learner
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
from kurt2rt.core.learner.conformance import broken_among
from kurt2rt.core.learner.learners import LEARNERS, find_learner
from kurt2rt.core.task_robot import require_robot_of
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.lockstep.compatibility import require_course
from kurt2rt.experiments.lockstep.learner_setting import learner_setting
from kurt2rt.knowledge.task_repertoire import load_task_repertoire

_TASK = "wall_following"
"""Task of KURT2 with whose world, repertoire and situation a part is tried that no task names."""
_SEED, _PURPOSE = 1, "plug-in check"


class Checked(NamedTuple):
    """Finding about one plug-in."""

    subject: Subject
    robot: str | None
    """Kind of the robot that it was tried on; None for a robot."""
    broken: list[str]
    """Promises that it breaks, each in a sentence."""
    note: str = ""
    """Time of a learner's decisions, in words; empty for another part."""


def check_all(subjects: Sequence[Subject], robot: str | None) -> list[Checked]:
    """Return what the checks of plug-ins found.

    `robot`: by name or path, for a single plug-in, and for those of several that name none; None: the plug-in's own,
    else KURT2. Raises UserError if a plug-in or robot cannot be loaded.
    """
    found = []
    for subject in subjects:
        named = robot or subject.robot if len(subjects) == 1 else subject.robot or robot
        settings = load_robot(named or DEFAULT_KIND)
        tried_on = None if subject.group == ROBOTS.group else settings.kind
        found.append(Checked(subject, tried_on, *PluginCheck(settings, simulations_of(settings)).of(subject)))
    return found


class PluginCheck:
    """Checks of all kinds, on one robot and its simulation."""

    def __init__(self, robot: RobotSettings, factory: SimulationFactory) -> None:
        """Take the robot, and what opens its simulations."""
        self._robot = robot
        self._factory = factory
        self._checks: Mapping[str, Callable[[str], list[str]]] = {
            POLICIES.group: self._of_policy,
            JUDGES.group: lambda name: broken_of_judge(_settings(AnyJudgeSettings, name)),
            METRICS.group: self._of_metric,
            BEHAVIOURS.group: self._of_action,
            TASKS.group: self._of_task,
            WORLDS.group: self._of_world,
            ROBOTS.group: lambda name: broken_of_robot(cast("RobotKind", find_robot_kind(name)), name),
        }

    def of(self, subject: Subject) -> Finding:
        """Return what was found about a plug-in. Raises UserError if it cannot be loaded, so that nothing is tried."""
        if subject.group == LEARNERS.group:
            setting = learner_setting(self._task(), self._robot, seed=_SEED)
            return check_learner(find_learner(subject.name), setting)
        return Finding(self._checks[subject.group](subject.name))

    def _task(self) -> TaskSettings:
        """Return the task to try parts with that no task names. Raises NoPluginError for a robot without tasks."""
        name = _TASK if self._robot.kind == DEFAULT_KIND else find_task_of_robot(self._robot.kind)
        if name is None:
            raise NoPluginError(
                "has no task, so nothing says its actions",
                where=f"robot {self._robot.kind}",
                do="add a task to its folder, or check the YAML of a task that names the part",
            )
        return load_task(name)

    def _of_policy(self, name: str) -> list[str]:
        settings = _settings(AnyPolicySettings, name)
        actions = load_task_repertoire(self._task(), self._robot)
        return broken_of_policy(settings, self._robot, actions, settings.behaviours or ("",))

    def _of_metric(self, name: str) -> list[str]:
        task = self._task()
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
        require_robot_of(task, name, robot)
        self._factory.require_worlds(*worlds)
        require_course(self._factory, task, worlds)
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
