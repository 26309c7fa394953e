"""Runs of a certificate: each draws its world and faults from its own number, the seed of robot and start."""

import random
from collections.abc import Sequence
from typing import NamedTuple

from kurt2rt.experiments.lockstep.faulty_sensor import FaultKind

SEED = "SEED"
"""Part of a world's name that stands for the run's number."""


class BrokenShare(NamedTuple):
    """Share of the runs with a broken sensor, and the sensors that may break."""

    share: float
    """0 to 1."""
    sensors: tuple[str, ...]
    """Names, such as s15."""


ALL_WORK = BrokenShare(0.0, ())


class Run(NamedTuple):
    """One drive without a teacher, repeated by `kurt2rt exam --seed NUMBER --world WORLD`."""

    number: int
    """Seed of the robot, its noise, its start and the choice of the world."""
    place: str
    """Kind of world, with SEED where each run has a world of its own."""
    broken: str = ""
    """Sensor that breaks and the way in which, such as s15=low; empty: all work."""

    @property
    def world(self) -> str:
        """Name of the world."""
        return self.place.replace(SEED, str(self.number))


def draw_runs(first: int, count: int, places: Sequence[str], broken: BrokenShare = ALL_WORK) -> list[Run]:
    """Return the runs of the numbers from `first` on; each place is equally likely for each run."""
    return [
        Run(number, random.Random(f"world of run {number}").choice(places), _draw_break(number, broken))
        for number in range(first, first + count)
    ]


def _draw_break(number: int, broken: BrokenShare) -> str:
    chance = random.Random(f"broken sensor of run {number}")
    if chance.random() >= broken.share:
        return ""
    return f"{chance.choice(broken.sensors)}={chance.choice(list(FaultKind))}"
