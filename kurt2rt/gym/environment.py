"""Gymnasium environment of one task: the agent takes the place of the RLAs, ten times a second."""

import math
from collections.abc import Collection, Mapping, Sequence
from typing import Any, NamedTuple, TypeAlias

import gymnasium
import numpy as np
from gymnasium.spaces import Box, Discrete, Space
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from config.settings import SettingsError
from hal.kurt2_settings import Kurt2Settings, load_kurt2
from hal.robot_settings import RobotSettings
from kurt2rt.core.perception.definition import SituationDefinition, load_situation
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.lockstep.compatibility import require_metric
from kurt2rt.experiments.lockstep.engine import Engine
from kurt2rt.gym.endings import TERMINAL, Ending, read_endings
from kurt2rt.gym.engines import open_drive, read_engine
from kurt2rt.gym.episode_setup import EpisodeSetup
from kurt2rt.gym.moment import AgentDrive, Moment
from kurt2rt.gym.rewards import DecisionOutcome, JudgeReward, build_reward
from kurt2rt.knowledge.task_repertoire import load_task_repertoire
from kurt2rt.platform.drive_picture import TRAIL, draw_robot, draw_trail
from simbridge.contracts.simulation import Pose, SimulationFactory
from simbridge.simulation import Kurt2SimulationFactory
from simbridge.worlds.world_loading import load_world

Observation: TypeAlias = NDArray[np.float64]
Info: TypeAlias = dict[str, Any]

_DECISION_S = 0.1
_MOST_SEEDS = 2**31
_SIDE_INCHES, _DOTS_PER_INCH = 6.0, 80


class TaskEnvironment(gymnasium.Env[Observation, np.int64]):
    """The simulated KURT2, by default behind its CAN bus, with the perception and the guard of the real runtime.

    The observation is the situation, an action is a place in `actions`, and a decision lasts for 0.1 s.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": round(1 / _DECISION_S)}  # noqa: RUF012 - as Gymnasium has it

    def __init__(
        self,
        task: str | TaskSettings,
        *,
        robot: Kurt2Settings | None = None,
        world: str | None = None,
        averages: bool = False,
        reward: str | None = None,
        ends_at: Collection[str] = (Ending.COLLISION.value, Ending.STUCK.value),
        duration_s: float | None = None,
        engine: str = Engine.CAN.value,
        render_mode: str | None = None,
    ) -> None:
        """Load the task.

        Args:
            task: name or path of a task with one behaviour, or the task itself.
            robot: settings of the KURT2; None: the shipped ones.
            world: name or path; None: the world that the task is taught in.
            averages: observe the averages of the last 10 s as well.
            reward: source of the rewards, "judge" or "teacher"; None: the judge if the task has one.
            ends_at: endings that terminate an episode, of "collision" and "stuck".
            duration_s: time after which an episode is truncated, in s; None: that of the task's exam.
            engine: "can" drives over the simulated CAN bus, "compiled" in the compiled batch, with the same numbers.
            render_mode: "rgb_array" for pictures of the world; None for none.

        Raises:
            config.settings.SettingsError: for a task, world or option that cannot be used.
        """
        self._settings = robot or load_kurt2()
        self._task = load_agent_task(task)
        self._factory = Kurt2SimulationFactory(self._settings)
        self._world = world or self._task.teaching.world
        self._factory.require_worlds(self._world)
        require_metric(self._factory, self._task, [self._world])
        self._reward = build_reward(self._task, reward)
        self._ends_at = read_endings(ends_at)
        self.engine = read_engine(engine)
        """Loop that drives the robot."""
        self._policy = self._task.policy.build(self._settings.infrared)
        cycle_s = self._settings.cycle_s
        self._decision_ticks = round(_DECISION_S / cycle_s)
        self._episode_ticks = round(self._checked_duration_s(duration_s) / cycle_s)
        definition = load_situation(self._task.situation, self._settings.infrared.names)
        names = definition.names if averages else definition.names[: len(definition.features)]
        self._averages = averages
        self.observation_names = names
        """Name of each value of an observation."""
        self.observation_space = observation_space(definition, self._settings, averages=averages)
        self.actions = tuple(load_task_repertoire(self._task, self._settings))
        """Name of each action."""
        self.action_space = Discrete(len(self.actions))
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise SettingsError(f"render_mode: unknown (got {render_mode}, allowed rgb_array)")
        self.render_mode = render_mode
        self._drive: AgentDrive | None = None
        self._picture: Picture | None = None
        """Drawing of the episode's world; None until the first frame of the episode."""

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Observation, Info]:
        """Set a robot down at the start of a new episode; return the observation and its information.

        Args:
            seed: makes the robot, its noise and its start, those of the exam with this seed; None: drawn at random.
            options: "world", a name or path; "start", a pose (x_m, y_m, heading_rad) in m and rad.

        Raises:
            BatchRefusedError: the batch does not know an action of the task, or a feature of its situation.
            config.settings.SettingsError: for an option that cannot be used.
        """
        super().reset(seed=seed)
        wanted = read_options(options, self._world, self._settings)
        run = int(self.np_random.integers(_MOST_SEEDS)) if seed is None else seed
        self.close()
        setup = EpisodeSetup(
            settings=self._settings,
            task=self._task,
            world=wanted.world,
            seed=run,
            start=wanted.start,
            ends_at=self._ends_at,
            ticks=self._episode_ticks,
            averages=self._averages,
            judged=isinstance(self._reward, JudgeReward),
        )
        self._drive = open_drive(self.engine, self._factory, setup)
        return self._observation(self._drive.moment), self._info(self._drive.moment)

    def step(self, action: np.int64 | int) -> tuple[Observation, float, bool, bool, Info]:
        """Drive by an action for 0.1 s; return observation, reward (-1, 0 or +1), terminated, truncated, information.

        Raises:
            gymnasium.error.ResetNeeded: no episode is under way.
            gymnasium.error.InvalidAction: `action` is not a place in `actions`.
        """
        drive = self._drive
        if drive is None or drive.moment.ending is not None:
            raise gymnasium.error.ResetNeeded("step: no episode is under way; call reset first")
        if action not in self.action_space:
            raise gymnasium.error.InvalidAction(
                f"step: unknown action (got {action}, allowed 0 to {len(self.actions) - 1}); give a place in `actions`"
            )
        name, answer = self.actions[action], self._teachers_answer(drive.moment)
        now = drive.drive(name, self._decision_ticks)
        reward = self._reward.reward(DecisionOutcome(name, answer, now.features))
        terminated = now.ending in TERMINAL
        truncated = now.ending is not None and not terminated
        return self._observation(now), float(reward), terminated, truncated, self._info(now)

    def render(self) -> NDArray[np.uint8] | None:
        """Return a picture of the world, RGB of shape (height, width, 3); None without a render mode.

        Raises gymnasium.error.ResetNeeded before the first episode.
        """
        if self.render_mode is None:
            return None
        if self._drive is None:
            raise gymnasium.error.ResetNeeded("render: there is no robot yet; call reset first")
        if self._picture is None:
            self._picture = Picture(self._factory, self._drive.world, self._settings)
        return self._picture.frame(self._drive.moment.pose, self._drive.trail)

    def close(self) -> None:
        """Stop the robot and close its bus; `reset` opens another one."""
        if self._drive is not None:
            self._drive.close()
        self._drive = self._picture = None

    def _checked_duration_s(self, duration_s: float | None) -> float:
        if duration_s is None:
            return self._task.exam.duration_s
        if not duration_s >= _DECISION_S:
            raise SettingsError(f"duration_s: too short (got {duration_s}, allowed {_DECISION_S} or more)")
        return duration_s

    def _observation(self, now: Moment) -> Observation:
        return now.situation[: len(self.observation_names)].copy()

    def _teachers_answer(self, now: Moment) -> str:
        """Return the action of the reference policy for an observation."""
        return self._policy.choose(now.counts, self._task.behaviours[0])

    def _info(self, now: Moment) -> Info:
        answer = self._teachers_answer(now)
        return {
            "teacher": {"name": answer, "index": self.actions.index(answer)},
            "action": now.action,
            "guard": tuple(reason.value for reason in now.guard),
            "pose": np.array(now.pose),
            "collisions": now.collisions,
            "progress": now.progress,
            "time_s": now.ticks * self._settings.cycle_s,
            "ending": "" if now.ending is None else now.ending.value,
        }


class Picture:
    """Drawing of one world, onto which `render` draws the robot of an episode frame by frame."""

    def __init__(self, factory: SimulationFactory, world: str, robot: RobotSettings) -> None:
        """Draw the walls. Raises config.settings.SettingsError for an unknown world."""
        self._robot = robot
        figure = Figure(figsize=(_SIDE_INCHES, _SIDE_INCHES), dpi=_DOTS_PER_INCH, layout="constrained")
        self._canvas = FigureCanvasAgg(figure)
        self._axes = figure.subplots()
        factory.draw(self._axes, world)

    def frame(self, pose: Pose, trail: Sequence[Pose]) -> NDArray[np.uint8]:
        """Return the world with the robot at a pose and the way that it came, RGB of shape (height, width, 3)."""
        walls = set(self._axes.get_children())
        draw_trail(self._axes, trail, "")
        draw_robot(self._axes, pose, self._robot.geometry.outline_m, TRAIL)
        self._canvas.draw()  # type: ignore[no-untyped-call]
        pixels = np.array(self._canvas.buffer_rgba(), dtype=np.uint8)[:, :, :3]  # type: ignore[no-untyped-call]
        for drawn in set(self._axes.get_children()) - walls:
            drawn.remove()
        return pixels


def observation_space(definition: SituationDefinition, robot: RobotSettings, *, averages: bool) -> Space[Observation]:
    """Return the float64 space of the recent values in counts, shape (n,), or with their averages, shape (2 * n,).

    Sensor values lie between 0 and the converter's 1023 counts; a wheel speed between the guard's limits.
    """
    top_speed = round(definition.wheel_speed_counts_per_m_s * robot.guard.maximum_speed_m_s)
    bounds = [feature.bounds(top_speed) for feature in definition.features]
    low, high = np.array(bounds * (2 if averages else 1), dtype=np.float64).T
    return Box(low, high, dtype=np.float64)


class ResetOptions(NamedTuple):
    """World and start pose of an episode, read from the `options` of `reset`."""

    world: str
    start: Pose | None
    """None: where the exam of the episode's seed begins."""


def read_options(options: Mapping[str, Any] | None, world: str, robot: RobotSettings) -> ResetOptions:
    """Return the options of a reset; `world` is taken if they name none.

    Raises config.settings.SettingsError for an unknown option or world, and for a start at which the robot has no room.
    """
    given = dict(options or {})
    world, start = given.pop("world", world), given.pop("start", None)
    if given:
        raise SettingsError(f"reset: unknown option (got {', '.join(sorted(given))}, allowed world, start)")
    if start is None:
        return ResetOptions(world, None)
    pose = _pose(start)
    if load_world(world, robot).clearance_m(pose, robot.geometry) == 0.0:
        raise SettingsError(f"reset: the robot has no room at start (got {start!r} in world {world})")
    return ResetOptions(world, pose)


def _pose(start: Any) -> Pose:
    try:
        pose = Pose(*map(float, start))
    except (TypeError, ValueError):
        pose = Pose(math.nan, math.nan, math.nan)
    if not all(map(math.isfinite, pose)):
        raise SettingsError(f"reset: start is not a pose (got {start!r}, allowed three numbers x_m, y_m, heading_rad)")
    return pose


def load_agent_task(named: str | TaskSettings) -> TaskSettings:
    """Return a task without its mid level. `named`: its name or path, or the task itself.

    Raises config.settings.SettingsError for a missing or invalid file, or for a task with several behaviours.
    """
    task = load_task(named) if isinstance(named, str) else named
    if len(task.behaviours) > 1:
        raise SettingsError(
            f"task {task.name}: an environment has one behaviour (got {', '.join(task.behaviours)})",
            do="give a task with one, such as turn_left",
        )
    return task.model_copy(update={"mid": None})
