"""Which RLAs stand on the very same condition: where they say different things, their worth decides between them."""

from kurt2rt.rla.rla import Condition, Rla


class CompetitorGroups:
    """All living RLAs, grouped by level, behaviour and exactly the same condition."""

    def __init__(self) -> None:
        self._members: dict[tuple[str, str, Condition], dict[int, Rla]] = {}
        self._group: dict[int, tuple[Rla, ...]] = {}
        """By the id of each member: asked in every tick, where hashing a condition would cost more than the answer."""

    def of(self, rla: Rla) -> tuple[Rla, ...]:
        """The living RLAs on the condition of an RLA, oldest first; it may itself have been deleted."""
        group = self._group.get(rla.rla_id)
        if group is None:
            return self._sorted(rla)
        return group

    def put(self, rla: Rla) -> None:
        """Add one, or put it in the place of what it was before."""
        self._members.setdefault(_place(rla), {})[rla.rla_id] = rla
        self._regroup(rla)

    def leave(self, rla: Rla) -> None:
        """Take out one that is there."""
        members = self._members[_place(rla)]
        del members[rla.rla_id], self._group[rla.rla_id]
        if members:
            self._regroup(rla)
        else:
            del self._members[_place(rla)]

    def _regroup(self, rla: Rla) -> None:
        group = self._sorted(rla)
        for member in group:
            self._group[member.rla_id] = group

    def _sorted(self, rla: Rla) -> tuple[Rla, ...]:
        members = self._members.get(_place(rla), {})
        return tuple(members[rla_id] for rla_id in sorted(members))


def _place(rla: Rla) -> tuple[str, str, Condition]:
    return rla.level, rla.behaviour, rla.condition
