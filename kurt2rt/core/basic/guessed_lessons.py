"""Guessed lessons: RLAs of a held action that differ from all lessons near them, which the robot asks about."""

from collections.abc import Mapping

from kurt2rt.core.rla.contradiction import find_contradiction
from kurt2rt.core.rla.lesson_history import hold_of
from kurt2rt.core.rla.match import Match
from kurt2rt.core.rla.rla import Rla
from kurt2rt.core.rla.rla_system import RlaSystem


class GuessedLessons:
    """Narrow radius of the RLAs of a hold whose five nearest neighbours of other presses all look different.

    The moment that a lesson of a hold is about is an estimate. That of an answer is not, because the robot stands while
    it asks. An answer that agrees is a neighbour that agrees, so the RLA has its whole radius again.
    """

    def __init__(self, system: RlaSystem, groups: Mapping[str, str], narrow_share: float) -> None:
        """Watch the RLAs of a system.

        Args:
            system: with the RLAs.
            groups: group of each action, as of behaviors.action_groups.
            narrow_share: fraction of R within which a guessed lesson answers.
        """
        self._system = system
        self._groups = groups
        self._narrow_share = narrow_share
        self._found: dict[int, bool] = {}
        """Whether an RLA is a guessed lesson, by its id, of the RLAs that were looked at since the last change."""
        self._changes = -1

    def narrowed(self, match: Match) -> Match:
        """Return a match with the narrow radius if its RLA is a guessed lesson, else the match."""
        radius = self._narrow_share * self._system.whole_radius(match.rla)
        if match.distance <= radius or not match.known or not self._is_guessed(match.rla):
            return match
        return match._replace(radius=radius)

    def _is_guessed(self, rla: Rla) -> bool:
        if self._changes != self._system.changes:
            self._changes = self._system.changes
            self._found.clear()
        found = self._found.get(rla.rla_id)
        if found is None:
            # Once for each RLA that answers after a lesson, because it computes all distances.
            found = hold_of(rla.origin.command_id) is not None and self._differs(rla)
            self._found[rla.rla_id] = found
        return found

    def _differs(self, rla: Rla) -> bool:
        return find_contradiction(self._system, rla, self._groups, of_other_presses=True) is not None
