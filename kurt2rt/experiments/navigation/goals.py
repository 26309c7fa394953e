"""Choice of goals: named places to which no tour led directly."""

import math
import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from behaviors.metrics.errands import ErrandsSettings
from behaviors.metrics.town import Street, Town, length_m


@dataclass(frozen=True, slots=True)
class GoalChosen:
    """Goal with its start and shortest way."""

    name: str
    start: Street
    street: Street
    """Street of the name."""
    shortest: tuple[Street, ...]
    """The shortest way there, both ends among them."""
    demonstrated_m: float
    """The shortest way that the robot was led from there to there in one piece; infinite where it never was."""

    @property
    def demonstrated(self) -> float:
        """Ratio of `demonstrated_m` and the shortest distance in m."""
        return self.demonstrated_m / length_m(self.shortest)


def choose_goals(
    town: Town,
    named: Mapping[str, Street],
    led: Sequence[Street | None],
    start: Street,
    settings: ErrandsSettings,
    chance: random.Random,
) -> tuple[GoalChosen, ...]:
    """Return successive goals, the first from `start`; fewer than required if there are none.

    Args:
        town: streets of the world.
        named: street of each named place.
        led: streets of the tour; None before each repositioning.
        start: street of the robot.
        settings: number of goals, and limits.
        chance: source of the choice.
    """
    chosen: list[GoalChosen] = []
    here = start
    while len(chosen) < settings.goals:
        possible = [
            goal
            for name, street in named.items()
            if street != here and (goal := _goal(town, name, here, street, led)) is not None
            if len(goal.shortest) > settings.junctions_at_least and goal.demonstrated > settings.detour_at_most
        ]
        if not possible:
            break
        goal = chance.choice(possible)
        chosen.append(goal)
        here = goal.street
    return tuple(chosen)


def _goal(town: Town, name: str, start: Street, street: Street, led: Sequence[Street | None]) -> GoalChosen | None:
    shortest = town.shortest(start, street)
    if shortest is None:
        return None
    return GoalChosen(name, start, street, shortest, demonstrated_m(led, start, street))


def demonstrated_m(led: Sequence[Street | None], start: Street, goal: Street) -> float:
    """Return the length in m of the shortest piece of the tour from one street to the other; infinite without one."""
    best_m, piece = math.inf, list[Street]()
    for street in led:
        if street is None:
            piece = []
        elif street == start:
            piece = [street]
        elif piece:
            piece.append(street)
        if street == goal and piece:
            best_m = min(best_m, length_m(piece))
            piece = []
    return best_m
