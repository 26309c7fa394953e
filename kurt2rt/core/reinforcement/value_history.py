"""What the actions of an RLA have earned: that of the present one, and, for an undo, that of those before it."""

from collections.abc import Collection, Mapping
from typing import Generic, TypeVar

EarnedT = TypeVar("EarnedT")


class ValueHistory(Generic[EarnedT]):
    """By RLA id; an RLA that gets another action begins anew, and its former account waits until that is undone.

    So does the account of one that is deleted; nothing is kept of one that can never come back.
    """

    def __init__(self) -> None:
        self.present: dict[int, EarnedT] = {}
        """Of the action that each RLA has now, where anything was earned."""
        self._former: dict[int, list[EarnedT | None]] = {}

    def depth(self, rla_id: int) -> int:
        """How many accounts lie below the present one."""
        return len(self._former.get(rla_id, ()))

    def reset(self, rla_id: int) -> None:
        """The RLA has another action now."""
        self._former.setdefault(rla_id, []).append(self.present.pop(rla_id, None))

    def restore_previous(self, rla_id: int) -> None:
        """The RLA has the action again that it had before."""
        former = self._former.get(rla_id)
        earned = former.pop() if former else None
        self.present.pop(rla_id, None)
        if earned is not None:
            self.present[rla_id] = earned

    def discard(self, rla_id: int) -> None:
        """The RLA never comes back."""
        self.present.pop(rla_id, None)
        self._former.pop(rla_id, None)

    def restore(self, saved: Mapping[int, EarnedT], only: Collection[int] | None) -> None:
        """The present accounts as they were saved: of all RLAs, or of some only."""
        if only is None:
            self.present = dict(saved)
            return
        for rla_id in only:
            self.present.pop(rla_id, None)
            if rla_id in saved:
                self.present[rla_id] = saved[rla_id]

    def get(self, rla_id: int, depth: int) -> EarnedT | None:
        """What lies at a depth; None where nothing was earned."""
        former = self._former.get(rla_id, [])
        return former[depth] if depth < len(former) else self.present.get(rla_id)

    def set(self, rla_id: int, depth: int, earned: EarnedT) -> None:
        """Put something else at a depth."""
        former = self._former.get(rla_id, [])
        if depth < len(former):
            former[depth] = earned
        else:
            self.present[rla_id] = earned
