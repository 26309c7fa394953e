"""Which RLAs stand on the very same condition: where they say different things, their worth decides between them."""

from kurt2rt.core.rla.condition import Condition
from kurt2rt.core.rla.rla import Rla


class CompetitorGroups:
    """All living RLAs, grouped by level, behaviour and exactly the same condition."""

    def __init__(self) -> None:
        self._members: dict[tuple[str, str, Condition], tuple[Rla, ...]] = {}
        """Oldest first."""
        self._group: dict[int, tuple[Rla, ...]] = {}
        """By the id of each member: asked in every tick, where hashing a condition would cost more than the answer."""

    def for_rla(self, rla: Rla) -> tuple[Rla, ...]:
        """The living RLAs on the condition of an RLA, oldest first; it may itself have been deleted."""
        group = self._group.get(rla.rla_id)
        if group is None:
            return self._members.get(_place(rla), ())
        return group

    def add_or_replace(self, rla: Rla) -> None:
        """Add one, or put it in the place of what it was before."""
        self._regroup(rla, (*self._others(rla), rla))

    def remove(self, rla: Rla) -> None:
        """Take out one that is there."""
        others = self._others(rla)
        del self._group[rla.rla_id]
        if others:
            self._regroup(rla, others)
        else:
            del self._members[_place(rla)]

    def _others(self, rla: Rla) -> tuple[Rla, ...]:
        return tuple(each for each in self._members.get(_place(rla), ()) if each.rla_id != rla.rla_id)

    def _regroup(self, rla: Rla, members: tuple[Rla, ...]) -> None:
        group = self._members[_place(rla)] = tuple(sorted(members, key=lambda member: member.rla_id))
        for member in group:
            self._group[member.rla_id] = group


def _place(rla: Rla) -> tuple[str, str, Condition]:
    return rla.level, rla.behaviour, rla.condition
