"""Options of `reset`: world and start of one episode."""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from hal.robot_settings import RobotSettings
from hal.settings import SettingsError
from hal.simulation import Pose
from simbridge.worlds.world_loading import load_world


class ResetOptions(NamedTuple):
    """World and start of an episode."""

    world: str
    start: Pose | None
    """None: where the exam of the episode's seed begins."""


def read_options(options: Mapping[str, Any] | None, world: str, robot: RobotSettings) -> ResetOptions:
    """Return the options of a reset; `world` is taken if they name none.

    Raises hal.settings.SettingsError for an unknown option or world, and for a start at which the robot has no room.
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
        raise SettingsError(f"reset: start is no pose (got {start!r}, allowed three numbers x_m, y_m, heading_rad)")
    return pose
