"""Protocol of a reinforcement rule: credits of a reward, and values of RLAs."""

from collections.abc import Collection, Iterable, Mapping
from typing import NamedTuple, Protocol

from kurt2rt.core.reinforcement.eligibility_trace import EligibilityTrace
from kurt2rt.core.rla.credit import Credit
from kurt2rt.core.rla.statistics import Statistics


class CreditUpdate(NamedTuple):
    """Credit with the action of its RLA that it belongs to."""

    credit: Credit
    depth: int
    """Result of `depth` when the reward was given."""


class ReinforcementRule(Protocol):
    """Reinforcement rule: learns from transitions and rewards. An undo subtracts credits only."""

    def update(self, rla_id: int | None, tick: int) -> None:
        """Learn from one tick; `rla_id`: answering RLA, None at standstill or outside its radius."""
        ...

    def credits_for(self, value: int, trace: EligibilityTrace) -> tuple[Credit, ...]:
        """Return the changes that a reward of -1 or +1 would make, without making them."""
        ...

    def learn(self, value: int, trace: EligibilityTrace) -> None:
        """Learn from a reward of -1 or +1: apply the changes of `credits_for`."""
        ...

    def apply_credits(self, updates: Iterable[CreditUpdate], sign: int) -> None:
        """Add credits of the journal (`sign` +1), or subtract them (-1) from existing values."""
        ...

    def value(self, rla_id: int) -> float:
        """Return the value of an RLA's present action, a score of about -1 to 1; more is better."""
        ...

    def depth(self, rla_id: int) -> int:
        """Return the number of earlier actions of an RLA that an undo can restore."""
        ...

    def reset(self, rla_id: int) -> None:
        """Start a new value for an RLA that got another action."""
        ...

    def restore_previous(self, rla_id: int) -> None:
        """Restore the value of the previous action, or of a restored RLA."""
        ...

    def archive(self, rla_id: int) -> None:
        """Keep the value of a deleted RLA, so that `restore_previous` can restore it after an undo."""
        ...

    def discard(self, rla_id: int) -> None:
        """Drop all values of an RLA whose creation was undone."""
        ...

    @property
    def values(self) -> Mapping[int, float]:
        """Values by RLA id, for the checkpoint; empty for edge weights."""
        ...

    @property
    def edge_weights(self) -> Mapping[tuple[int, int], float]:
        """Weights by transition, for the checkpoint; empty for TD(lambda)."""
        ...

    def restore(self, saved: Statistics, only: Collection[int] | None = None) -> None:
        """Restore saved values of all RLAs, or of `only` some."""
        ...
