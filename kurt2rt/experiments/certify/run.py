"""Runs of a certificate and their outcomes: each draws its world and faults from its number, the seed of the robot."""

import random
from collections.abc import Sequence
from typing import NamedTuple

from hal.settings import Settings
from kurt2rt.experiments.lockstep.faulty_sensor import FaultKind
from kurt2rt.experiments.study.jobs import world_of


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
        return world_of(self.place, self.number)


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


class RunOutcome(Settings):
    """Counts of one run; ticks are counted from 1."""

    number: int
    world: str
    broken: str = ""
    """Sensor that broke and the way in which, such as s15=low; empty: all worked."""
    ticks: int
    """Ticks until the end, or until the robot was stuck or stopped."""
    unknown_ticks: int
    """Ticks in which it stood in an unknown situation."""
    questions: int
    """Times that it began to stand there."""
    first_question: int
    """Tick of the first question; 0: none."""
    collisions: int
    first_collision: int
    """Tick of the first collision; 0: none."""
    stuck: bool
    """True if it stayed in place for too long without being stopped; this ends the run."""
    stopped: str = ""
    """Watch that stopped it until a teacher comes: for a broken sensor, or the guard's; empty without a stop."""
    travelled_m: float
    end: tuple[float, float, float]
    """Pose after the last tick: x, y in m, heading in rad."""

    @property
    def clean(self) -> bool:
        """True without a collision, a question, a stop and being stuck."""
        return not (self.collisions or self.questions or self.stopped or self.stuck)

    def differing(self, other: "RunOutcome") -> list[str]:
        """Return the names of the fields that differ."""
        return [name for name in type(self).model_fields if getattr(self, name) != getattr(other, name)]
