"""The repertoire: every action by name, built for one robot."""

from collections.abc import Mapping

from behaviors.behaviour import Behaviour
from behaviors.keep_distance import KeepDistance
from behaviors.motor_primitive import MotorPrimitive
from behaviors.repertoire_settings import (
    ActionSettings,
    KeepDistanceAction,
    MotorAction,
    RepertoireSettings,
    TurnByAngleAction,
)
from behaviors.turn_by_angle import TurnByAngle
from hal.robot import WheelSpeeds
from hal.robot_settings import RobotSettings
from hal.settings import SettingsError, find_config, load_settings

Repertoire = Mapping[str, Behaviour]
"""Behaviours by the name that stands in an RLA's action part."""


def load_repertoire(name_or_path: str, robot: RobotSettings) -> dict[str, Behaviour]:
    """Build the actions of a repertoire for a robot. Raises SettingsError."""
    path = find_config("repertoires", name_or_path)
    settings = load_settings(path, RepertoireSettings)
    repertoire: dict[str, Behaviour] = {}
    for position, action in enumerate(settings.actions):
        try:
            repertoire[action.name] = _build(action, robot)
        except ValueError as error:
            allowed = ", ".join(robot.infrared.names)
            raise SettingsError(
                f"{path}: actions.{position} ({action.name}): {error}; the robot's sensors are {allowed}"
            ) from error
    return repertoire


def _build(action: ActionSettings, robot: RobotSettings) -> Behaviour:
    match action:
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
