"""Groups of actions that a person can tell apart by watching the robot."""

import math
from collections.abc import Mapping

from behaviors.repertoire_settings import (
    KeepDistanceAction,
    MotorAction,
    RepertoireSettings,
    TurnByAngleAction,
)
from config.settings import load_settings
from config.settings_files import find_config
from hal.robot import WheelSpeeds

AHEAD, BACK, STAND = "ahead", "back", "stand"
_AHEAD_BELOW, _SPIN_ABOVE = 0.5, 2.0
"""Difference of the sides' speeds, as a fraction of the speed ahead.

Bearing left or right (0.25) looks like driving ahead within a second; curves have 0.9 and 1.2.
"""
_STAND_M_S = 0.02


def action_groups(repertoire: str) -> Mapping[str, str]:
    """Return the group of each action of a repertoire: ahead, back, stand, or a bend or spin to one side.

    Actions of one group look alike to a person who watches; contradictions and mistakes are told by it. Actions that
    were taught themselves are groups of their own.

    Raises:
        config.settings.SettingsError: for a missing or invalid repertoire.
    """
    actions = load_settings(find_config("repertoires", repertoire), RepertoireSettings).actions
    speeds = usual_speeds(repertoire)
    return {each.name: _group_of_speeds(*speeds[each.name]) if each.name in speeds else each.name for each in actions}


def usual_speeds(repertoire: str) -> Mapping[str, WheelSpeeds]:
    """Return the usual speeds of the wheels by each action of a repertoire, but for those that were taught themselves.

    Raises:
        config.settings.SettingsError: for a missing or invalid repertoire.
    """
    found: dict[str, WheelSpeeds] = {}
    for action in load_settings(find_config("repertoires", repertoire), RepertoireSettings).actions:
        match action:
            case MotorAction(left_m_s=left_m_s, right_m_s=right_m_s):
                found[action.name] = WheelSpeeds(left_m_s, right_m_s)
            case KeepDistanceAction(speed_m_s=speed_m_s):
                found[action.name] = WheelSpeeds(speed_m_s, speed_m_s)
            case TurnByAngleAction(angle_deg=angle_deg, speed_m_s=speed_m_s):
                right_m_s = math.copysign(speed_m_s, angle_deg)
                found[action.name] = WheelSpeeds(-right_m_s, right_m_s)
    return found


def _group_of_speeds(left_m_s: float, right_m_s: float) -> str:
    speed_m_s, difference_m_s = (left_m_s + right_m_s) / 2.0, right_m_s - left_m_s
    if max(abs(left_m_s), abs(right_m_s)) < _STAND_M_S:
        return STAND
    if abs(difference_m_s) > _SPIN_ABOVE * abs(speed_m_s):
        return f"spin {_side(difference_m_s)}"
    if speed_m_s < 0.0:
        return BACK
    return AHEAD if abs(difference_m_s) < _AHEAD_BELOW * speed_m_s else f"bend {_side(difference_m_s)}"


def _side(left_positive: float) -> str:
    return "left" if left_positive > 0.0 else "right"
