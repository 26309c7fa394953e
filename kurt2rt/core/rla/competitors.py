"""RLAs with equal conditions: their values decide between them if their actions differ."""

from kurt2rt.core.rla.condition import Condition
from kurt2rt.core.rla.rla import Rla


class CompetitorGroups:
    """Active RLAs, grouped by level, behaviour and equal condition."""

    def __init__(self) -> None:
        self._members: dict[tuple[str, str, Condition], tuple[Rla, ...]] = {}
        """Oldest first."""
        self._group: dict[int, tuple[Rla, ...]] = {}
        """By member id: read in each tick, in which hashing a condition would cost more than the lookup."""

    def for_rla(self, rla: Rla) -> tuple[Rla, ...]:
        """Return the active RLAs on the condition of an RLA, oldest first; the RLA itself may be deleted."""
        group = self._group.get(rla.rla_id)
        if group is None:
            return self._members.get(_group_key(rla), ())
        return group

    def add_or_replace(self, rla: Rla) -> None:
        """Add an RLA, or replace the one of its id."""
        self._regroup(rla, (*self._others(rla), rla))

    def remove(self, rla: Rla) -> None:
        """Remove an RLA from the group of its condition. Raises KeyError if it is in none."""
        others = self._others(rla)
        del self._group[rla.rla_id]
        if others:
            self._regroup(rla, others)
        else:
            del self._members[_group_key(rla)]

    def _others(self, rla: Rla) -> tuple[Rla, ...]:
        return tuple(each for each in self._members.get(_group_key(rla), ()) if each.rla_id != rla.rla_id)

    def _regroup(self, rla: Rla, members: tuple[Rla, ...]) -> None:
        group = self._members[_group_key(rla)] = tuple(sorted(members, key=lambda member: member.rla_id))
        for member in group:
            self._group[member.rla_id] = group


def _group_key(rla: Rla) -> tuple[str, str, Condition]:
    return rla.level, rla.behaviour, rla.condition
