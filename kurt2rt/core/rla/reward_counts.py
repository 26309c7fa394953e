"""Numbers of rewards and punishments of each RLA (paper, phase 3)."""

from typing import NamedTuple


class Appraisal(NamedTuple):
    """Number of rewards (+1) and punishments (-1) of one RLA."""

    rewards: int = 0
    punishments: int = 0


class RewardCounts:
    """Appraisals of all RLAs, by id."""

    def __init__(self) -> None:
        self._appraisals: dict[int, Appraisal] = {}

    def get(self, rla_id: int) -> Appraisal:
        """Return the numbers of an RLA; zeros without rewards."""
        return self._appraisals.get(rla_id, Appraisal())

    def add(self, rla_id: int, value: int) -> None:
        """Count one reward; `value` is -1 or +1."""
        self._count(rla_id, value, 1)

    def remove(self, rla_id: int, value: int) -> None:
        """Subtract one reward that was undone; `value` is -1 or +1."""
        self._count(rla_id, value, -1)

    def _count(self, rla_id: int, value: int, step: int) -> None:
        rewards, punishments = self.get(rla_id)
        self._appraisals[rla_id] = (
            Appraisal(rewards + step, punishments) if value > 0 else Appraisal(rewards, punishments + step)
        )
