"""Nearest neighbour without R: the action of the nearest label, however far it is."""

from collections.abc import Sequence

from kurt2rt.core.learner.label_learner import LabelLearner, Points


class NearestNeighbour(LabelLearner):
    """1-NN: it asks before its first lesson and never again, so all else is taught by corrections."""

    def fit(self, points: Points, actions: Sequence[str]) -> None:  # noqa: ARG002 - distances take the points
        """Keep the actions of the points (n, d)."""
        self._said = list(actions)

    def choose(self, point: Points, *, taught: bool) -> str | None:  # noqa: ARG002 - it never asks
        """Return the action of the label nearest to a point (d,); of equally near ones the newest."""
        newest_first = self.distances(point)[::-1]
        return self._said[::-1][int(newest_first.argmin())]
