"""Closed loops through streets: at each junction one of the ways on is right."""

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from behaviors.metrics.streets import Junction, Side, StreetMap
from config.settings import SettingsError
from simbridge.contracts.simulation import Pose

_TRIES = 100_000

_Step = tuple[Side, Junction]
"""A street: the way along it, and the junction that it leads to."""


@dataclass(frozen=True, slots=True)
class Leg:
    """Street of a route as it is driven, with the junction at its end and the way out of it."""

    way: Side
    """The way along the street."""
    junction: Junction
    """It leads there."""
    leaves: Side
    """The way out of that junction, which is the next leg's."""
    behind: Junction
    """Junction at the start of the street."""

    @property
    def quarters(self) -> int:
        """Quarter turns to the left at its end: 0, 1, or -1."""
        return (self.leaves - self.way + 1) % 4 - 1

    @property
    def middle(self) -> Pose:
        """Half-way along the street, in its middle, looking ahead."""
        ahead, behind = self.junction, self.behind
        return Pose((ahead.x_m + behind.x_m) / 2, (ahead.y_m + behind.y_m) / 2, self.way.heading_rad)


@dataclass(frozen=True, slots=True)
class Route:
    """Closed way through streets, leg by leg: the last leg ends where the first begins."""

    legs: tuple[Leg, ...]

    @property
    def quarters(self) -> tuple[int, ...]:
        """Quarter turns to the left at each junction, in order."""
        return tuple(leg.quarters for leg in self.legs)


def random_route(streets: StreetMap, decisions: int, quarters: Sequence[int], chance: random.Random) -> Route:
    """Return a closed loop past `decisions` junctions, drawn from a random walk that never turns back.

    The loop may cross itself and use a street twice, but repeats no shorter loop.

    Args:
        streets: of the world.
        decisions: number of junctions.
        quarters: allowed turns, in quarters to the left.
        chance: source of the walk.

    Raises:
        config.settings.SettingsError: the streets have no such loop.
    """
    allowed = set(quarters)
    on = {step: tuple(_steps_on(streets, step, allowed)) for step in _steps(streets)}
    begins = sorted(on, key=_order)
    # Of an odd number there is none on a grid, which a hundred thousand walks would find out too.
    possible = any(_leads_back(on, first, decisions) for first in begins)
    for _ in range(_TRIES if possible else 0):
        walk = _walk(on, chance.choice(begins), decisions, chance)
        if walk is not None and not _repeats(walk):
            return _closed(walk)
    raise SettingsError(f"metric route: these streets have no loop of {decisions} decisions", do="give another number")


def _leads_back(on: dict[_Step, tuple[_Step, ...]], first: _Step, decisions: int) -> bool:
    """Return whether a walk of so many steps ends at its start."""
    there = {first}
    for _ in range(decisions):
        there = {following for step in there for following in on[step]}
    return first in there


def _walk(
    on: dict[_Step, tuple[_Step, ...]], first: _Step, decisions: int, chance: random.Random
) -> tuple[_Step, ...] | None:
    """Return a closed random walk of so many steps; None if this walk did not close."""
    walk = [first]
    while len(walk) < decisions:
        if not on[walk[-1]]:
            return None
        walk.append(chance.choice(on[walk[-1]]))
    return tuple(walk) if first in on[walk[-1]] else None


def _repeats(walk: Sequence[_Step]) -> bool:
    """Return whether the walk repeats a shorter loop."""
    size = len(walk)
    return any(size % part == 0 and all(walk[k] == walk[k % part] for k in range(size)) for part in range(1, size))


def _closed(walk: Sequence[_Step]) -> Route:
    size = len(walk)
    return Route(
        tuple(Leg(way, junction, walk[(k + 1) % size][0], walk[k - 1][1]) for k, (way, junction) in enumerate(walk))
    )


def _steps(streets: StreetMap) -> Iterator[_Step]:
    """Yield every street between two junctions, in both directions."""
    for behind in streets.junctions:
        for way in behind.arms:
            junction = streets.neighbour(behind, way)
            if junction is not None:
                yield way, junction


def _steps_on(streets: StreetMap, step: _Step, allowed: set[int]) -> Iterator[_Step]:
    way, junction = step
    for turn in sorted(allowed):
        leaves = way.turned(turn)
        following = streets.neighbour(junction, leaves) if leaves in junction.arms else None
        if following is not None:
            yield leaves, following


def _order(step: _Step) -> tuple[float, float, int]:
    way, junction = step
    return junction.x_m, junction.y_m, int(way)
