"""The contract of a reinforcement rule: what a signal changes, and what an RLA is worth by it."""

from collections.abc import Collection, Iterable, Mapping
from typing import NamedTuple, Protocol

from kurt2rt.core.reinforcement.eligibility_trace import EligibilityTrace
from kurt2rt.core.rla.credit import Credit
from kurt2rt.core.rla.statistics import Statistics


class CreditUpdate(NamedTuple):
    """A credit, and to which action of its RLA it belongs."""

    credit: Credit
    depth: int
    """As `depth` told it when the credit was given."""


class ReinforcementRule(Protocol):
    """Learns from what follows what, and from signals. All of it is statistics: undo takes credits off, no more."""

    def update(self, rla_id: int | None, tick: int) -> None:
        """Take in one tick: the RLA that answered; None where the robot stood, or nobody may be blamed."""
        ...

    def credits_for(self, value: int, trace: EligibilityTrace) -> tuple[Credit, ...]:
        """By what a signal of -1 or +1 would change the worth of each RLA; changes nothing."""
        ...

    def learn(self, value: int, trace: EligibilityTrace) -> None:
        """Learn from a signal: worths change by what `credits_of` says."""
        ...

    def apply_credits(self, bookings: Iterable[CreditUpdate], sign: int) -> None:
        """Add credits from the journal (+1), or take them off again (-1), where there is anything to take them off."""
        ...

    def value(self, rla_id: int) -> float:
        """What the action is worth that an RLA has now; the more the better, 1 at most, or about."""
        ...

    def depth(self, rla_id: int) -> int:
        """How many actions an RLA has had before, which can be come back to."""
        ...

    def reset(self, rla_id: int) -> None:
        """The RLA has got another action, which begins anew."""
        ...

    def restore_previous(self, rla_id: int) -> None:
        """The RLA has got back the action that it had before, or has come back itself, with what it had earned."""
        ...

    def archive(self, rla_id: int) -> None:
        """The RLA was deleted; it may come back."""
        ...

    def discard(self, rla_id: int) -> None:
        """The RLA is no more, and never comes back."""
        ...

    @property
    def values(self) -> Mapping[int, float]:
        """For the checkpoint: values by RLA; empty for a rule without."""
        ...

    @property
    def edge_weights(self) -> Mapping[tuple[int, int], float]:
        """For the checkpoint: weights by transition; empty for a rule without."""
        ...

    def restore(self, saved: Statistics, only: Collection[int] | None = None) -> None:
        """Go on from what was saved, of all RLAs or of some only."""
        ...
