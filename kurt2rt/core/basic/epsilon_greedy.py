"""Epsilon-greedy choice among competitors: RLAs on the same condition with different actions (paper, phase 3)."""

import random
from collections.abc import Callable, Sequence

from kurt2rt.core.rla.rla import Rla


class EpsilonGreedy:
    """Choice among RLAs of one condition by their values, at random with a probability of epsilon.

    A choice holds until its group was not nearest for `hold_ticks` or is punished.
    """

    def __init__(self, value: Callable[[int], float], *, epsilon: float, hold_ticks: int, seed: int) -> None:
        """`value` returns the value of an RLA by its id; `epsilon` is the probability of a random choice, 0 to 1."""
        self._value = value
        self._epsilon = epsilon
        self._hold_ticks = hold_ticks
        self._chance = random.Random(f"choice {seed}")
        self._chosen: dict[int, tuple[int, int]] = {}
        """Chosen RLA and the tick in which its group was nearest last, by the id of the group's oldest RLA."""
        self.explores = False
        """Explore randomly; only while the results are learnt from."""

    def choose(self, group: Sequence[Rla], tick: int) -> Rla:
        """Return the RLA of a group that answers in a tick, at random with probability epsilon.

        `group`: RLAs with an equal condition, oldest first, at least one.
        """
        candidates = [rla for rla in group if not rla.is_withdrawn] or group
        rla = self._previous(group, candidates, tick) or self._draw(candidates)
        self._chosen[group[0].rla_id] = (rla.rla_id, tick)
        return rla

    def preview(self, group: Sequence[Rla], tick: int) -> Rla:
        """Return the RLA of a group that would answer in a tick without random exploration; change nothing.

        `group`: RLAs with an equal condition, oldest first, at least one.
        """
        candidates = [rla for rla in group if not rla.is_withdrawn] or group
        return self._previous(group, candidates, tick) or self.best(candidates)

    def best(self, group: Sequence[Rla]) -> Rla:
        """Return the RLA of highest value that has an action; of equal values the newest.

        If none has an action, return the best of all. The newest was tried because the values of the older ones had
        sunk. So a restarted robot, which may have lost these values, goes on with it.
        """
        candidates = [rla for rla in group if not rla.is_withdrawn] or group
        return max(candidates, key=lambda rla: (self._value(rla.rla_id), rla.rla_id))

    def reset(self) -> None:
        """Forget all choices, because values have changed."""
        self._chosen.clear()

    def _previous(self, group: Sequence[Rla], candidates: Sequence[Rla], tick: int) -> Rla | None:
        """Return the held choice of a group; None if there is none."""
        chosen, nearest_last = self._chosen.get(group[0].rla_id, (0, 0))
        if tick - nearest_last > self._hold_ticks:
            return None
        return next((each for each in candidates if each.rla_id == chosen), None)

    def _draw(self, candidates: Sequence[Rla]) -> Rla:
        if self.explores and self._chance.random() < self._epsilon:
            return self._chance.choice(candidates)
        return self.best(candidates)
