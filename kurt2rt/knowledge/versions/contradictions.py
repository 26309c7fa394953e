"""Contradictions between RLAs of two files: different actions at nearly the same condition."""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from hal.robot_settings import RobotSettings
from kurt2rt.core.critic.sides import critic_of
from kurt2rt.core.mid.settings import load_mid_level
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.perception.weights import feature_weights
from kurt2rt.core.rla.events import RlaCreated
from kurt2rt.core.rla.rla import BASIC, CRITIC, MID, Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.space import Space
from kurt2rt.core.task_settings import TaskSettings


class Radii(NamedTuple):
    """Distances of a task within which two conditions count as the same."""

    spaces: Mapping[str, Space]
    """Space of each level."""
    fractions: Mapping[str, float]
    """Fraction of R within which a correction replaces an RLA and does not insert one, by level."""

    def empty_system(self) -> RlaSystem:
        """Return an RLA system of these levels without any RLA."""
        basic = self.spaces[BASIC]
        others = {level: space for level, space in self.spaces.items() if level != BASIC}
        return RlaSystem(basic.dimensions, basic.radius, basic.weights, others=others)


class Overlap(NamedTuple):
    """An RLA that is near a condition."""

    rla: Rla
    distance: float
    """Distance from the condition, in the unit of the task."""
    radius: float
    """R of the RLA, in the same unit."""


def load_radii(task: TaskSettings, robot: RobotSettings) -> Radii:
    """Return the radii of a task on a robot. Raises hal.settings.SettingsError."""
    definition = load_situation(task.situation, robot.infrared.names)
    changed = ((each.features, each.weight) for each in task.learning.weights)
    weights = feature_weights(definition, changed, task.learning.past_weight, task.name)
    critic = critic_of(task.critic, robot)
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
    """Search for RLAs of one file that contradict an RLA of another file."""

    def __init__(self, rlas: Iterable[Rla], radii: Radii) -> None:
        """Index the RLAs; those that are withdrawn, or of a level that the task does not have, contradict none."""
        self._fractions = radii.fractions
        self._system = radii.empty_system()
        for rla in sorted(rlas, key=lambda each: each.rla_id):
            if not rla.is_withdrawn:
                self._system.apply(RlaCreated(rla))

    def find(self, rla: Rla) -> Overlap | None:
        """Return the RLA of the other file that is nearest to the condition of `rla`, if the two contradict.

        They do if it is within the fraction of R and acts differently; otherwise None is returned.
        """
        fraction = self._fractions.get(rla.level)
        if fraction is None:
            return None
        match = self._system.match(np.array(rla.condition), rla.behaviour, rla.level)
        if match is None or match.distance > fraction * match.radius or match.rla.action == rla.action:
            return None
        return Overlap(match.rla, match.distance, match.radius)
