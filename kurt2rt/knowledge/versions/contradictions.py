"""Which RLA of some file answers where one of another file does: what would contradict it."""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from hal.robot_settings import RobotSettings
from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.mid.settings import load_mid_level
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.perception.weights import feature_weights
from kurt2rt.core.rla.rla import BASIC, CRITIC, MID, Rla, RlaCreated
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.space import Space
from kurt2rt.core.task_settings import TaskSettings


class Radii(NamedTuple):
    """How near two conditions are the same, in the distances of a task."""

    spaces: Mapping[str, Space]
    """By level."""
    fractions: Mapping[str, float]
    """By level: within this share of R a correction replaces, and does not insert."""


class Overlap(NamedTuple):
    """An RLA, and how far it is."""

    rla: Rla
    distance: float
    radius: float


def load_radii(task: TaskSettings, robot: RobotSettings) -> Radii:
    """Those of a task on a robot. Raises hal.settings.SettingsError."""
    definition = load_situation(task.situation, robot.infrared.names)
    changed = ((each.features, each.weight) for each in task.learning.weights)
    weights = feature_weights(definition, changed, task.learning.past_weight, task.name)
    critic = load_critic(task.critic)
    radius = critic.learning.radius
    spaces = {
        BASIC: Space(definition.dimensions, task.learning.radius, weights),
        CRITIC: Space(len(critic.names), radius, critic.weight_vector),
    }
    fractions = {BASIC: task.learning.insert_beyond_share, CRITIC: critic.learning.insert_beyond_share}
    if task.mid is not None:
        mid = load_mid_level(task.mid)
        spaces[MID], fractions[MID] = mid.space, mid.learning.insert_beyond_share
    return Radii(spaces, fractions)


class Contradictions:
    """RLAs of one file, asked which of them says something else at the condition of another file's RLA."""

    def __init__(self, rlas: Iterable[Rla], borders: Radii) -> None:
        """Of levels that the task does not have nothing is near. RLAs that ask contradict nobody."""
        self._shares = borders.fractions
        basic = borders.spaces[BASIC]
        self._system = RlaSystem(basic.dimensions, basic.radius, basic.weights, others=borders.spaces)
        for rla in sorted(rlas, key=lambda each: each.rla_id):
            if not rla.is_withdrawn:
                self._system.apply(RlaCreated(rla))

    def of(self, rla: Rla) -> Overlap | None:
        """The nearest to its condition, if it lies within the share of R there and has another action."""
        share = self._shares.get(rla.level)
        if share is None:
            return None
        match = self._system.match(np.array(rla.condition), rla.behaviour, rla.level)
        if match is None or match.distance > share * match.radius or match.rla.action == rla.action:
            return None
        return Overlap(match.rla, match.distance, match.radius)
