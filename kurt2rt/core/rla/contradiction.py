"""Contradictions: RLAs whose nearest neighbours all do something else, as after a slip of a finger; and guesses."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from kurt2rt.core.rla.lesson_history import hold_of
from kurt2rt.core.rla.rla import BASIC, Rla
from kurt2rt.core.rla.rla_system import RlaSystem

NEIGHBOURS = 5
"""Neighbours that must all differ. Of the RLAs that differ from so many, 41 to 45 % were wrong where 11 to 15 % of all
were (docs/notebook.md#contradictions)."""

_LOOKED_AT = 2 * NEIGHBOURS + 1
"""Nearest RLAs that are looked at for neighbours: itself, and some that were withdrawn."""
_LOOKED_AT_OTHER_PRESSES = 6 * NEIGHBOURS + 1
"""The same where neighbours of the same hold are passed over; a hold of 2 s gives at most 20."""


class Contradiction(NamedTuple):
    """RLA of the basic level whose five nearest neighbours all have an action of another group.

    Often a wrong press taught it: page and terminal offer an undo; `kurt2rt knowledge contradictions` lists all.
    """

    rla: Rla
    neighbours: tuple[Rla, ...]
    """The five nearest that have an action, nearest first."""

    @property
    def actions(self) -> tuple[str, ...]:
        """Actions of the neighbours, each once, that of the nearest first."""
        return tuple(dict.fromkeys(each.action for each in self.neighbours))


def find_contradiction(
    system: RlaSystem, rla: Rla, groups: Mapping[str, str], *, of_other_presses: bool = False
) -> Contradiction | None:
    """Return the neighbours that an RLA contradicts; None if one of them agrees, or five are not to be found.

    Computes all distances: for explanations, not for each tick.

    Args:
        system: with the RLA and its neighbours, those of its behaviour.
        rla: of any level; only those of the basic level that have an action contradict anything.
        groups: group of each action, as of behaviors.action_groups.
        of_other_presses: pass over neighbours that the same hold taught, because one press cannot confirm itself.
    """
    if rla.level != BASIC or rla.is_withdrawn:
        return None
    hold = hold_of(rla.origin.command_id) if of_other_presses else None
    limit = _LOOKED_AT if hold is None else _LOOKED_AT_OTHER_PRESSES
    near = system.nearest_first(np.array(rla.condition), rla.behaviour, limit=limit)
    neighbours: list[Rla] = []
    for other, _ in near:
        if other.rla_id == rla.rla_id or other.is_withdrawn:
            continue
        if hold is not None and hold_of(other.origin.command_id) == hold:
            continue
        if groups.get(other.action, other.action) == groups.get(rla.action, rla.action):
            return None
        neighbours.append(other)
        if len(neighbours) == NEIGHBOURS:
            return Contradiction(rla, tuple(neighbours))
    return None


class GuessedLessons:
    """RLAs of a hold whose five nearest neighbours of other presses all do something that looks different.

    The moment that a lesson of a hold is about is an estimate, and a slip of the finger lasts as long as the hold. An
    answer is about a robot that stands, so it is never a guess. A guess that a later press confirms is none.
    """

    def __init__(self, system: RlaSystem, groups: Mapping[str, str]) -> None:
        """Watch the RLAs of a system; `groups`: group of each action, as of behaviors.action_groups."""
        self._system = system
        self._groups = groups
        self._found: dict[int, bool] = {}
        """Whether an RLA is a guess, by its id, of the RLAs that were looked at since the last change."""
        self._changes = -1

    def includes(self, rla: Rla) -> bool:
        """Return whether an RLA of the system is a guess."""
        if self._changes != self._system.changes:
            self._changes = self._system.changes
            self._found.clear()
        found = self._found.get(rla.rla_id)
        if found is None:
            # Once for each RLA that answers after a change, because it computes all distances.
            contradicted = hold_of(rla.origin.command_id) is not None and find_contradiction(
                self._system, rla, self._groups, of_other_presses=True
            )
            found = self._found[rla.rla_id] = bool(contradicted)
        return found
