"""Which of several competitors answers: RLAs on the very same condition with different actions (paper, phase 3)."""

import random
from collections.abc import Callable, Sequence

from kurt2rt.core.rla.rla import Rla


class EpsilonGreedy:
    """Epsilon-greedy by worth; a choice stands until its group has not been nearest for a while, or comes blame."""

    def __init__(self, value: Callable[[int], float], *, epsilon: float, hold_ticks: int, seed: int) -> None:
        """`worth` of an RLA by its id."""
        self._value = value
        self._epsilon = epsilon
        self._hold_ticks = hold_ticks
        self._chance = random.Random(f"choice {seed}")
        self._chosen: dict[int, tuple[int, int]] = {}
        """By the oldest of each group: the one that was chosen, and when it was nearest last."""
        self.explores = False
        """Whether chance has its share; only while something is learnt from what comes of it."""

    def choose(self, group: Sequence[Rla], tick: int) -> Rla:
        """The one that answers in a tick, of a group of at least one, oldest first."""
        candidates = [rla for rla in group if not rla.is_withdrawn] or group
        rla = self._previous(group, candidates, tick) or self._draw(candidates)
        self._chosen[group[0].rla_id] = (rla.rla_id, tick)
        return rla

    def preview(self, group: Sequence[Rla], tick: int) -> Rla:
        """Which one `among` would say, chance left out; nothing is chosen by asking."""
        candidates = [rla for rla in group if not rla.is_withdrawn] or group
        return self._previous(group, candidates, tick) or self.best(candidates)

    def best(self, group: Sequence[Rla]) -> Rla:
        """The one of most worth that has an action; of equals the newest.

        It was tried because those before it had sunk: also a robot that was started anew, and no longer knows how far
        they had, goes on with it.
        """
        candidates = [rla for rla in group if not rla.is_withdrawn] or group
        return max(candidates, key=lambda rla: (self._value(rla.rla_id), rla.rla_id))

    def reset(self) -> None:
        """Choose anew: somebody was blamed, or worths have changed otherwise."""
        self._chosen.clear()

    def _previous(self, group: Sequence[Rla], candidates: Sequence[Rla], tick: int) -> Rla | None:
        """The one that was chosen before, while that stands."""
        chosen, nearest_last = self._chosen.get(group[0].rla_id, (0, 0))
        if tick - nearest_last > self._hold_ticks:
            return None
        return next((each for each in candidates if each.rla_id == chosen), None)

    def _draw(self, candidates: Sequence[Rla]) -> Rla:
        if self.explores and self._chance.random() < self._epsilon:
            return self._chance.choice(candidates)
        return self.best(candidates)
