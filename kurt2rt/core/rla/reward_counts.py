"""What teachers thought of what each RLA decided (paper, phase 3)."""

from typing import NamedTuple


class Appraisal(NamedTuple):
    """How often teachers praised and blamed what an RLA decided (paper, phase 3)."""

    rewards: int = 0
    punishments: int = 0


class RewardCounts:
    """Those of all RLAs, by their ids."""

    def __init__(self) -> None:
        self._of: dict[int, Appraisal] = {}

    def get(self, rla_id: int) -> Appraisal:
        """What teachers thought of an RLA; none and none where nobody said so."""
        return self._of.get(rla_id, Appraisal())

    def add(self, rla_id: int, value: int) -> None:
        """A reward (1) or a punishment (-1) is given."""
        self._count(rla_id, value, 1)

    def remove(self, rla_id: int, value: int) -> None:
        """One that was given is taken back."""
        self._count(rla_id, value, -1)

    def _count(self, rla_id: int, value: int, more: int) -> None:
        rewards, punishments = self.get(rla_id)
        self._of[rla_id] = (
            Appraisal(rewards + more, punishments) if value > 0 else Appraisal(rewards, punishments + more)
        )
