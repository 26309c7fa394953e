"""Locally weighted vote that never asks, to see what its questions are worth."""

from kurt2rt.core.learner.label_learner import Points
from kurt2rt.experiments.rivals.learners.weighted_vote import WeightedVote


class VoteWithoutGate(WeightedVote):
    """Vote of the 10 nearest labels, however far they are; it asks before its first lesson only."""

    def choose(self, point: Points, *, taught: bool) -> str | None:  # noqa: ARG002 - it never asks
        """Return the action with the heaviest votes of the labels nearest to a point (d,)."""
        return self.vote(self.distances(point))
