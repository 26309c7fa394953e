"""Random choices that are equal on every machine."""

import random
from collections.abc import Sequence
from typing import TypeVar

T = TypeVar("T")


class SeededRandom:
    """Random choices of a generated world, seeded by its name, equal in every version of Python.

    Only Random.random() is used: the one sequence that Python guarantees.
    """

    def __init__(self, text: str) -> None:
        self._random = random.Random(text).random

    def length_m(self, least_m: float, most_m: float) -> float:
        """Return a random length in m, in whole centimetres, bounds included."""
        return round(round(least_m * 100) + self.integer(round((most_m - least_m) * 100) + 1)) / 100

    def integer(self, count: int) -> int:
        """Return a random integer from 0 to below `count`."""
        return int(self._random() * count)

    def choice(self, choices: Sequence[T]) -> T:
        """Return a random element of a sequence that is not empty."""
        return choices[self.integer(len(choices))]

    def chance(self, probability: float) -> bool:
        """Return True with this probability."""
        return self._random() < probability
