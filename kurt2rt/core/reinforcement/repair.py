"""Repair of an RLA whose value is below the threshold: ask the teacher, or try another action in phase 5."""

import math
from collections import Counter
from collections.abc import Callable, Iterable

import numpy as np

from kurt2rt.core.reinforcement.settings import ReinforcementSettings, ValueSettings
from kurt2rt.core.rla.condition import Condition
from kurt2rt.core.rla.events import ActionWithdrawn, Lesson, RlaCreated, RlaDeleted
from kurt2rt.core.rla.matching import exact_square
from kurt2rt.core.rla.rla import Origin, Rla
from kurt2rt.core.rla.rla_system import RlaSystem

OriginOf = Callable[[str], Origin]
"""Function from a suffix of the command id to the origin of a repair."""


class Repair:
    """Generator of the lessons that repair an RLA; the caller applies each before requesting the next."""

    def __init__(self, system: RlaSystem, value: Callable[[int], float], settings: ReinforcementSettings) -> None:
        """`value`: value of an RLA by its id."""
        self._system = system
        self._value = value
        self._settings = settings
        self._thresholds: ValueSettings = settings.with_teacher
        self._tried: dict[tuple[str, Condition], list[str]] = {}
        """Actions tried on each condition with competitors and at least one active RLA."""
        self._condition_key_of: dict[int, tuple[str, Condition]] = {}
        """Key of each active RLA on those conditions."""
        self._rolled_back: dict[tuple[str, Condition], list[str]] = {}
        """Actions that a rollback removed from a condition: not tried there again in this run."""

    def set_thresholds(self, thresholds: ValueSettings) -> None:
        """Use the thresholds of another phase."""
        self._thresholds = thresholds

    def is_below_threshold(self, rla_id: int) -> bool:
        """Return whether an RLA is active, has an action, and has a value below the threshold."""
        rla = self._system.get(rla_id)
        return rla is not None and not rla.is_withdrawn and self._value(rla_id) < self._thresholds.sunk_below

    def _is_healthy(self, rla: Rla) -> bool:
        return not rla.is_withdrawn and self._value(rla.rla_id) > self._thresholds.well_above

    def forget_rolled_back(self) -> None:
        """Forget repairs that earlier runs rolled back."""
        self._rolled_back.clear()

    def on_created(self, rla: Rla) -> None:
        """Record the action of an RLA as tried if other RLAs share its condition."""
        group = self._system.competitors(rla)
        if len(group) > 1:
            key = _condition_key(rla)
            tried = self._tried.setdefault(key, [])
            tried.extend(each.action for each in group if each.action not in tried)
            self._condition_key_of.update((each.rla_id, key) for each in group)

    def on_deleted(self, rla_id: int) -> None:
        """Note the deletion of an RLA; forget the tried actions of its condition if it was the last one there."""
        key = self._condition_key_of.pop(rla_id, None)
        if key is not None and key not in self._condition_key_of.values():
            del self._tried[key]

    def on_creation_undone(self, created: Rla, *, rolled_back: bool) -> None:
        """Make the action of an RLA untried again, unless a rollback removed the RLA."""
        key = _condition_key(created)
        tried = self._tried.get(key, [])
        if created.action in tried:
            tried.remove(created.action)
            if rolled_back:
                self._rolled_back.setdefault(key, []).append(created.action)
        self.on_deleted(created.rla_id)

    def withdraw(self, rla_id: int, origin_of: OriginOf) -> Iterable[Lesson]:
        """Yield the lesson that makes the robot ask instead of driving by an RLA: none, or one.

        The RLA's action is withdrawn; if other RLAs share its condition, the RLA is deleted. `origin_of`: maker of the
        lesson's origin from a suffix of its command id.
        """
        rla = self._system.get(rla_id)
        if rla is None or rla.is_withdrawn:
            return
        if len(self._system.competitors(rla)) > 1:
            yield RlaDeleted(rla_id, origin_of(f"delete-{rla_id}"))
        else:
            yield ActionWithdrawn(rla_id, rla.action, origin_of(f"withdraw-{rla_id}"))

    def try_other_action(self, rla_id: int, origin_of: OriginOf) -> Iterable[Lesson]:
        """Yield a competitor with a neighbour's action, or the deletion of all competitors after enough tries.

        Nothing is deleted if no neighbour covers the condition: the robot would stand there without a teacher.
        `origin_of`: maker of a lesson's origin from a suffix of its command id.
        """
        rla = self._system.get(rla_id)
        if rla is None or rla.is_withdrawn:
            return
        group = self._system.competitors(rla)
        if any(self._is_healthy(each) for each in group):
            yield RlaDeleted(rla_id, origin_of(f"delete-{rla_id}"))
            return
        key = _condition_key(rla)
        tried = [*self._tried.get(key, [rla.action]), *self._rolled_back.get(key, ())]
        action = self._action_to_try(rla, tried) if len(tried) <= self._settings.most_competitors else None
        if action is None:
            for each in group if self._neighbour_covers(rla) else ():
                yield RlaDeleted(each.rla_id, origin_of(f"delete-{each.rla_id}"))
            return
        new_id = self._system.next_id
        origin = origin_of(f"try-{new_id}")
        yield RlaCreated(Rla(new_id, rla.condition, action, rla.radius, origin, rla.behaviour, rla.level))

    def _neighbour_covers(self, rla: Rla) -> bool:
        """Return whether the condition of an RLA lies inside the radius of a neighbour that has an action."""
        near = next((each for each in self._system.neighbours(rla, len(self._system)) if not each.is_withdrawn), None)
        if near is None:
            return False
        off = (np.array(near.condition) - np.array(rla.condition)) * self._system.weights
        return math.sqrt(exact_square(off)) <= (self._system.radius if near.radius is None else near.radius)

    def _action_to_try(self, rla: Rla, tried: list[str]) -> str | None:
        """Return the most frequent untried action of the nearest neighbours; None if all were tried."""
        nearest = self._system.neighbours(rla, self._settings.neighbours)
        votes = Counter(each.action for each in nearest if self._is_healthy(each))
        return next((action for action, _ in votes.most_common() if action not in tried), None)


def _condition_key(rla: Rla) -> tuple[str, Condition]:
    return rla.behaviour, rla.condition
