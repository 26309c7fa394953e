"""What becomes of an RLA that has sunk: asked anew where somebody can be asked, else another action is tried."""

import math
from collections import Counter
from collections.abc import Callable, Iterable

import numpy as np

from kurt2rt.core.reinforcement.settings import ReinforcementSettings, ValueSettings
from kurt2rt.core.rla.condition import Condition
from kurt2rt.core.rla.matching import exact_square
from kurt2rt.core.rla.rla import ActionWithdrawn, Lesson, Origin, Rla, RlaCreated, RlaDeleted
from kurt2rt.core.rla.rla_system import RlaSystem

OriginOf = Callable[[str], Origin]
"""Origin of a change, of which a word tells what it is and to which RLA."""


class Repair:
    """Makes the changes that mend an RLA; whoever asks for them applies them, one after the other."""

    def __init__(self, system: RlaSystem, worth: Callable[[int], float], settings: ReinforcementSettings) -> None:
        """`worth` of an RLA by its id."""
        self._system = system
        self._value = worth
        self._settings = settings
        self._thresholds: ValueSettings = settings.with_teacher
        self._tried: dict[tuple[str, Condition], list[str]] = {}
        """Actions tried on a condition, by behaviour and condition, where there were competitors and any RLA lives."""
        self._condition_key_of: dict[int, tuple[str, Condition]] = {}
        """Of the RLAs that live on those conditions."""
        self._rolled_back: dict[tuple[str, Condition], list[str]] = {}
        """Actions whose try made things worse: they are not tried there again in this run."""

    def set_thresholds(self, worths: ValueSettings) -> None:
        """What counts as sunk and as well from now on."""
        self._thresholds = worths

    def is_below_threshold(self, rla_id: int) -> bool:
        """Whether an RLA lives, has an action, and is worth too little."""
        rla = self._system.get(rla_id)
        return rla is not None and not rla.is_withdrawn and self._value(rla_id) < self._thresholds.sunk_below

    def _is_healthy(self, rla: Rla) -> bool:
        return not rla.is_withdrawn and self._value(rla.rla_id) > self._thresholds.well_above

    def forget_rolled_back(self) -> None:
        """All that was heard up to now was of earlier runs."""
        self._rolled_back.clear()

    def on_created(self, rla: Rla) -> None:
        """An RLA was created, or its deletion undone: where others stand on its condition, it was a try."""
        group = self._system.competitors(rla)
        if len(group) > 1:
            place = _condition_key(rla)
            tried = self._tried.setdefault(place, [])
            tried.extend(each.action for each in group if each.action not in tried)
            self._condition_key_of.update((each.rla_id, place) for each in group)

    def on_deleted(self, rla_id: int) -> None:
        """An RLA was deleted: what was tried on its condition counts as long as another one lives there."""
        place = self._condition_key_of.pop(rla_id, None)
        if place is not None and place not in self._condition_key_of.values():
            del self._tried[place]

    def on_creation_undone(self, created: Rla, *, rolled_back: bool) -> None:
        """The creation of an RLA was undone, `rolled_back`: because things had become worse."""
        place = _condition_key(created)
        tried = self._tried.get(place, [])
        if created.action in tried:
            tried.remove(created.action)
            if rolled_back:
                self._rolled_back.setdefault(place, []).append(created.action)
        self.on_deleted(created.rla_id)

    def withdraw(self, rla_id: int, origin_of: OriginOf) -> Iterable[Lesson]:
        """Withdraw the action of an RLA that has sunk, so that its teacher is asked; a competitor is not needed."""
        rla = self._system.get(rla_id)
        if rla is None or rla.is_withdrawn:
            return
        if len(self._system.competitors(rla)) > 1:
            yield RlaDeleted(rla_id, origin_of(f"delete-{rla_id}"))
        else:
            yield ActionWithdrawn(rla_id, rla.action, origin_of(f"withdraw-{rla_id}"))

    def try_other_action(self, rla_id: int, origin_of: OriginOf) -> Iterable[Lesson]:
        """Where nobody is asked: a competitor with a neighbour's action, or an end to all once enough were tried.

        Not where no neighbour reaches: the robot would stand there, and nobody would come.
        """
        rla = self._system.get(rla_id)
        if rla is None or rla.is_withdrawn:
            return
        group = self._system.competitors(rla)
        if any(self._is_healthy(each) for each in group):
            yield RlaDeleted(rla_id, origin_of(f"delete-{rla_id}"))
            return
        place = _condition_key(rla)
        tried = [*self._tried.get(place, [rla.action]), *self._rolled_back.get(place, ())]
        action = self._action_to_try(rla, tried) if len(tried) <= self._settings.most_competitors else None
        if action is None:
            for each in group if self._neighbour_covers(rla) else ():
                yield RlaDeleted(each.rla_id, origin_of(f"delete-{each.rla_id}"))
            return
        new_id = self._system.next_id
        origin = origin_of(f"try-{new_id}")
        yield RlaCreated(Rla(new_id, rla.condition, action, rla.radius, origin, rla.behaviour, rla.level))

    def _neighbour_covers(self, rla: Rla) -> bool:
        """Whether the condition of an RLA lies within the radius of another one that has an action."""
        near = next((each for each in self._system.neighbours(rla, len(self._system)) if not each.is_withdrawn), None)
        if near is None:
            return False
        off = (np.array(near.condition) - np.array(rla.condition)) * self._system.weights
        return math.sqrt(exact_square(off)) <= (self._system.radius if near.radius is None else near.radius)

    def _action_to_try(self, rla: Rla, tried: list[str]) -> str | None:
        """What most of the nearest neighbours do that was not tried; None where all they do was."""
        nearest = self._system.neighbours(rla, self._settings.neighbours)
        votes = Counter(each.action for each in nearest if self._is_healthy(each))
        return next((action for action, _ in votes.most_common() if action not in tried), None)


def _condition_key(rla: Rla) -> tuple[str, Condition]:
    return rla.behaviour, rla.condition
