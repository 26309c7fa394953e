"""The motor primitives among the actions of a repertoire, with their set points."""

from collections.abc import Mapping

from behaviors.repertoire_settings import MotorAction, RepertoireSettings
from hal.robot import WheelSpeeds
from hal.settings import load_settings
from hal.settings_files import find_config


def primitive_speeds(repertoire: str) -> Mapping[str, WheelSpeeds]:
    """Return the wheel speeds of a repertoire's motor primitives by name, in the repertoire's order.

    Raises hal.settings.SettingsError if the repertoire is missing or invalid.
    """
    actions = load_settings(find_config("repertoires", repertoire), RepertoireSettings).actions
    return {
        action.name: WheelSpeeds(action.left_m_s, action.right_m_s)
        for action in actions
        if isinstance(action, MotorAction)
    }
