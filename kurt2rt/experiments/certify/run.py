"""Runs of a certificate: each draws its world from its own number, which is also the seed of robot and start."""

import random
from collections.abc import Sequence
from typing import NamedTuple

SEED = "SEED"
"""Part of a world's name that stands for the run's number."""


class Run(NamedTuple):
    """One drive without a teacher, repeated by `kurt2rt exam --seed NUMBER --world WORLD`."""

    number: int
    """Seed of the robot, its noise, its start and the choice of the world."""
    place: str
    """Kind of world, with SEED where each run has a world of its own."""

    @property
    def world(self) -> str:
        """Name of the world."""
        return self.place.replace(SEED, str(self.number))


def draw_runs(first: int, count: int, places: Sequence[str]) -> list[Run]:
    """Return the runs of the numbers from `first` on; each place is equally likely for each run."""
    return [
        Run(number, random.Random(f"world of run {number}").choice(places)) for number in range(first, first + count)
    ]


def draw_witnesses(runs: Sequence[Run], share: float, at_least: int) -> list[Run]:
    """Return a share of the runs, 0 to 1, but at least so many, chosen by chance."""
    wanted = min(len(runs), max(at_least, round(share * len(runs))))
    return random.Random(f"witnesses of {len(runs)} runs from {runs[0].number}").sample(runs, wanted)
