"""The motor primitives among the actions of a repertoire."""

from behaviors.repertoire_settings import MotorAction, RepertoireSettings
from hal.settings import find_config, load_settings


def primitives(repertoire: str) -> tuple[str, ...]:
    """Return the names of a repertoire's motor primitives.

    Raises hal.settings.SettingsError if the repertoire is missing or invalid.
    """
    actions = load_settings(find_config("repertoires", repertoire), RepertoireSettings).actions
    return tuple(action.name for action in actions if isinstance(action, MotorAction))
