"""Guessed lessons: RLAs of a held action that differ from all lessons near them."""

from collections.abc import Mapping

from kurt2rt.core.rla.contradiction import find_contradiction
from kurt2rt.core.rla.lesson_history import hold_of
from kurt2rt.core.rla.rla import Rla
from kurt2rt.core.rla.rla_system import RlaSystem


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
            found = hold_of(rla.origin.command_id) is not None and self._differs(rla)
            self._found[rla.rla_id] = found
        return found

    def _differs(self, rla: Rla) -> bool:
        return find_contradiction(self._system, rla, self._groups, of_other_presses=True) is not None
