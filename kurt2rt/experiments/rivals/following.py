"""Lessons that act at once: the share after which the robot decides as it was told, in the situation of the lesson."""

from collections.abc import Sequence

import numpy as np

from kurt2rt.core.rla.events import ActionReplaced, RlaCreated, TeachingEvent
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.core.rla.rla_system import RlaSystem


def followed_by_rlas(system: RlaSystem, events: Sequence[TeachingEvent]) -> float | None:
    """Return the share of lessons that RLAs follow at once, 0 to 1; None without a lesson of the basic level.

    `system`: an empty system of the task, which learns `events`, oldest first.
    """
    follows = []
    for event in events:
        system.apply(event)
        if not isinstance(event, RlaCreated | ActionReplaced):
            continue
        rla = event.rla if isinstance(event, RlaCreated) else system.get(event.rla_id)
        if rla is not None and rla.level == BASIC:
            match = system.match(np.array(rla.condition), rla.behaviour)
            follows.append(match is not None and match.known and match.rla.action == rla.action)
    return sum(follows) / len(follows) if follows else None
