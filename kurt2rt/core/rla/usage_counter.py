"""Counts of uses and transitions: the RLA network (paper, section III.B)."""

from collections import Counter
from collections.abc import Callable, Container

from kurt2rt.core.rla.rla import BASIC


class StatisticsCounter:
    """Counter of uses of RLAs and of transitions between them, per level.

    An RLA is used once each time it becomes the driving one; standstill ends a chain of transitions.
    """

    def __init__(
        self, uses: dict[int, int] | None = None, transitions: dict[tuple[int, int], int] | None = None
    ) -> None:
        self.uses = Counter(uses)
        self.transitions = Counter(transitions)
        self._followers: dict[int, tuple[int, ...]] = {}
        """Follow-ups of each RLA, for a lookup without a search; tuples take less memory than sets."""
        for before, after in self.transitions:
            self._add_follower(before, after)
        self._previous: dict[str, int | None] = {}
        """Driving RLA of the last tick, by level."""

    def follow_ups(self, rla_id: int) -> dict[int, int]:
        """Return follow-up id -> number of transitions from this RLA."""
        return {after: self.transitions[rla_id, after] for after in sorted(self._followers.get(rla_id, ()))}

    def count(self, current: int | None, level: str = BASIC, *, again: bool = False) -> None:
        """Count one tick; `current`: driving RLA of the level, None at standstill.

        `again`: count a further use if the same RLA was chosen once more.
        """
        previous = self._previous.get(level)
        if current == previous and not again:
            return
        if current is not None:
            self.uses[current] += 1
            if previous is not None:
                if (previous, current) not in self.transitions:
                    self._add_follower(previous, current)
                self.transitions[previous, current] += 1
        self._previous[level] = current

    def drop_deleted(self, is_active: Callable[[int], bool]) -> None:
        """Drop the RLAs for which `is_active` returns False: autonomous robots create and delete many in a day."""
        deleted = {rla_id for rla_id in self.uses if not is_active(rla_id)}
        if not deleted:
            return
        for rla_id in deleted:
            del self.uses[rla_id]
        for edge in [edge for edge in self.transitions if not deleted.isdisjoint(edge)]:
            del self.transitions[edge]
        for rla_id in deleted:
            self._followers.pop(rla_id, None)
        for before, followers in self._followers.items():
            if not deleted.isdisjoint(followers):
                self._followers[before] = tuple(after for after in followers if after not in deleted)
        self._reset_predecessors(deleted)

    def drop_follow_ups(self, rla_id: int) -> None:
        """Drop the counted transitions from an RLA whose action has changed."""
        for after in self._followers.pop(rla_id, ()):
            del self.transitions[rla_id, after]
        self._reset_predecessors((rla_id,))

    def _add_follower(self, before: int, after: int) -> None:
        self._followers[before] = (*self._followers.get(before, ()), after)

    def _reset_predecessors(self, rla_ids: Container[int]) -> None:
        """Count no transition from these RLAs into the next one."""
        for level, previous in self._previous.items():
            if previous in rla_ids:
                self._previous[level] = None
