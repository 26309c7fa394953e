"""How often each RLA was used and what followed it: the counts behind the RLA network (paper, III.B)."""

from collections import Counter
from collections.abc import Callable, Container

from kurt2rt.core.rla.rla import BASIC


class StatisticsCounter:
    """Counts activations of RLAs and transitions between them, for each level by itself; ids run through.

    An RLA is used once each time it becomes the one that drives; standing still ends a chain of transitions.
    """

    def __init__(
        self, uses: dict[int, int] | None = None, transitions: dict[tuple[int, int], int] | None = None
    ) -> None:
        self.uses = Counter(uses)
        self.transitions = Counter(transitions)
        self._followers: dict[int, tuple[int, ...]] = {}
        """Of each RLA that was ever followed: to look at one must not cost looking at all. Sets take much more room."""
        for before, after in self.transitions:
            self._add_follower(before, after)
        self._previous: dict[str, int | None] = {}
        """By level."""

    def follow_ups(self, rla_id: int) -> dict[int, int]:
        """How often each RLA followed this one."""
        return {after: self.transitions[rla_id, after] for after in sorted(self._followers.get(rla_id, ()))}

    def count(self, current: int | None, level: str = BASIC, *, anew: bool = False) -> None:
        """Take in one tick: the RLA of a level that drives, None while none does.

        `anew`: it was decided on once more, so it is another use though it be the same one.
        """
        previous = self._previous.get(level)
        if current == previous and not anew:
            return
        if current is not None:
            self.uses[current] += 1
            if previous is not None:
                if (previous, current) not in self.transitions:
                    self._add_follower(previous, current)
                self.transitions[previous, current] += 1
        self._previous[level] = current

    def drop_deleted(self, lives: Callable[[int], bool]) -> None:
        """Forget the RLAs of which `lives` says no: in a day on its own a robot tries, and deletes, a great many."""
        dead = {rla_id for rla_id in self.uses if not lives(rla_id)}
        if not dead:
            return
        for rla_id in dead:
            del self.uses[rla_id]
        for edge in [edge for edge in self.transitions if not dead.isdisjoint(edge)]:
            del self.transitions[edge]
        for rla_id in dead:
            self._followers.pop(rla_id, None)
        for before, followers in self._followers.items():
            if not dead.isdisjoint(followers):
                self._followers[before] = tuple(after for after in followers if after not in dead)
        self._reset_predecessors(dead)

    def drop_follow_ups(self, rla_id: int) -> None:
        """Forget what followed this RLA: with another action it leads elsewhere."""
        for after in self._followers.pop(rla_id, ()):
            del self.transitions[rla_id, after]
        self._reset_predecessors((rla_id,))

    def _add_follower(self, before: int, after: int) -> None:
        """For the first time."""
        self._followers[before] = (*self._followers.get(before, ()), after)

    def _reset_predecessors(self, rla_ids: Container[int]) -> None:
        """What comes next follows none of these."""
        for level, previous in self._previous.items():
            if previous in rla_ids:
                self._previous[level] = None
