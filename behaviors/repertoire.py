"""Repertoire: the actions by name, built for one robot."""

from collections.abc import Callable, Mapping
from pathlib import Path

from behaviors.behaviour import Behaviour
from behaviors.contained_behaviour import ContainedBehaviour
from behaviors.keep_distance import KeepDistance
from behaviors.motor_primitive import MotorPrimitive
from behaviors.repertoire_settings import (
    KeepDistanceAction,
    MotorAction,
    PluginAction,
    RepertoireSettings,
    TaskAction,
    TaughtAction,
    TurnByAngleAction,
)
from behaviors.turn_by_angle import TurnByAngle
from config.plugins import PluginError
from config.settings import SettingsError, load_settings
from config.settings_files import find_config
from hal.robot import WheelSpeeds
from hal.robot_settings import RobotSettings

Repertoire = Mapping[str, Behaviour]
"""All actions of a task, by the names that RLAs and commands use, such as {"forward": MotorPrimitive(...)}.

A file of `config/repertoires` lists them; `load_repertoire` builds them for one robot. A robot is not started with an
RLA whose action its repertoire lacks."""


BuildTaught = Callable[[TaughtAction | TaskAction, Path], Behaviour]
"""Builder of a taught action from its entry and the path of the repertoire file. Raises ValueError."""


def load_repertoire(
    name_or_path: str, robot: RobotSettings, build_taught: BuildTaught | None = None
) -> dict[str, Behaviour]:
    """Return the actions of a shipped repertoire or a file, built for a robot, by action name.

    Args:
        name_or_path: name in `config/repertoires`, or a path.
        robot: settings of the robot.
        build_taught: builder of actions that are RLA systems, which this package does not know; None refuses them.

    Raises:
        config.settings.SettingsError: for a missing or invalid file or entry, which it names.
    """
    path = find_config("repertoires", name_or_path)
    settings = load_settings(path, RepertoireSettings)
    repertoire: dict[str, Behaviour] = {}
    for position, action in enumerate(settings.actions):
        place = f"{path}: actions.{position} ({action.name})"
        if isinstance(action, TaughtAction | TaskAction):
            repertoire[action.name] = _build_taught(action, path, place, build_taught)
            continue
        try:
            repertoire[action.name] = _build(action, robot)
        except PluginError as error:
            raise SettingsError(error.what, where=place, do=error.do) from error
        except ValueError as error:
            allowed = ", ".join(robot.infrared.names)
            raise SettingsError(str(error), where=place, do=f"the robot's sensors are {allowed}") from error
    return repertoire


def _build_taught(action: TaughtAction | TaskAction, path: Path, place: str, build: BuildTaught | None) -> Behaviour:
    if build is None:
        raise SettingsError(
            f"is of kind {action.kind}, and nothing taught can act here", where=place, do="leave it out"
        )
    try:
        return build(action, path)
    except ValueError as error:
        raise SettingsError(str(error), where=place) from error


def _build(
    action: MotorAction | KeepDistanceAction | TurnByAngleAction | PluginAction, robot: RobotSettings
) -> Behaviour:
    match action:
        case PluginAction():
            return ContainedBehaviour(action, robot)
        case MotorAction():
            return MotorPrimitive(WheelSpeeds(action.left_m_s, action.right_m_s))
        case KeepDistanceAction():
            return KeepDistance(
                robot.infrared,
                front_sensor=action.front_sensor,
                back_sensor=action.back_sensor,
                distance_m=action.distance_m,
                speed_m_s=action.speed_m_s,
                gain_per_m=action.gain_per_m,
            )
        case TurnByAngleAction():
            return TurnByAngle(robot.geometry, angle_deg=action.angle_deg, speed_m_s=action.speed_m_s)


def primitive_speeds(repertoire: str) -> Mapping[str, WheelSpeeds]:
    """Return the wheel speeds of a repertoire's motor primitives by name, in the repertoire's order.

    Raises config.settings.SettingsError if the repertoire is missing or invalid.
    """
    actions = load_settings(find_config("repertoires", repertoire), RepertoireSettings).actions
    return {
        action.name: WheelSpeeds(action.left_m_s, action.right_m_s)
        for action in actions
        if isinstance(action, MotorAction)
    }
