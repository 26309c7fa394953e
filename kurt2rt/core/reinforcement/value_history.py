"""History of values: of each RLA's present action, and of its earlier actions for an undo."""

from collections.abc import Collection, Mapping


class ValueHistory:
    """Values by RLA id, as a stack per RLA: a new action or a deletion pushes, its undo pops."""

    def __init__(self) -> None:
        self.present: dict[int, float] = {}
        """Value of each RLA's present action, if rewards changed it."""
        self._former: dict[int, list[float | None]] = {}

    def depth(self, rla_id: int) -> int:
        """Return the number of earlier actions of an RLA whose values are kept."""
        return len(self._former.get(rla_id, ()))

    def reset(self, rla_id: int) -> None:
        """Push the present value of an RLA that got another action; the new action has no value."""
        self._former.setdefault(rla_id, []).append(self.present.pop(rla_id, None))

    def restore_previous(self, rla_id: int) -> None:
        """Pop the value of an RLA's previous action and make it the present one."""
        former = self._former.get(rla_id)
        earned = former.pop() if former else None
        self.present.pop(rla_id, None)
        if earned is not None:
            self.present[rla_id] = earned

    def discard(self, rla_id: int) -> None:
        """Drop the present and all earlier values of an RLA."""
        self.present.pop(rla_id, None)
        self._former.pop(rla_id, None)

    def restore(self, saved: Mapping[int, float], only: Collection[int] | None) -> None:
        """Restore saved present values by RLA id: of all RLAs, or of `only` some."""
        if only is None:
            self.present = dict(saved)
            return
        for rla_id in only:
            self.present.pop(rla_id, None)
            if rla_id in saved:
                self.present[rla_id] = saved[rla_id]

    def get(self, rla_id: int, depth: int) -> float | None:
        """Return the value (dimensionless) of an RLA's action at a depth, 0 the first action; None without rewards."""
        former = self._former.get(rla_id, [])
        return former[depth] if depth < len(former) else self.present.get(rla_id)

    def set(self, rla_id: int, depth: int, earned: float) -> None:
        """Replace the value (dimensionless) of an RLA's action at a depth, 0 the first action."""
        former = self._former.get(rla_id, [])
        if depth < len(former):
            former[depth] = earned
        else:
            self.present[rla_id] = earned
