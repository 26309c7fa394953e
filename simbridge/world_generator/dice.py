"""Chance that falls alike on every machine."""

import random
from collections.abc import Sequence
from typing import TypeVar

T = TypeVar("T")


class SeededRandom:
    """Choices made from a text; only Random.random() is used, the one sequence that Python promises never to change."""

    def __init__(self, text: str) -> None:
        self._random = random.Random(text).random

    def length_m(self, least_m: float, most_m: float) -> float:
        """A length in whole centimetres, bounds included: sums of them differ nowhere by a last bit that matters."""
        return round(round(least_m * 100) + self.integer(round((most_m - least_m) * 100) + 1)) / 100

    def integer(self, count: int) -> int:
        """A whole number from 0 to below count."""
        return int(self._random() * count)

    def choice(self, choices: Sequence[T]) -> T:
        """One of them."""
        return choices[self.integer(len(choices))]

    def chance(self, probability: float) -> bool:
        """True in this share of cases."""
        return self._random() < probability
