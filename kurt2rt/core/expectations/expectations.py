"""The expectations of all RLAs of one level: learned at each end of an RLA, from the situation that it ended in."""

import math
from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.expectations.surprise import Surprise, SurpriseSettings
from kurt2rt.core.rla.expectation import Expectation, pack
from kurt2rt.core.rla.rla import (
    ActionReplaced,
    ActionWithdrawn,
    LessonRedone,
    LessonUndone,
    RlaCreated,
    RlaDeleted,
    TeachingEvent,
)
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.space import Space


class End(NamedTuple):
    """An RLA has ended, and another one took over."""

    rla_id: int
    follow_up: int
    situation: NDArray[np.float64]
    """That it ended in, shape (d,)."""
    ticks: int
    """How long it had driven."""


class Expectations:
    """Learns what follows each RLA of one level, and says how surprising it is. A robot that stands learns nothing.

    An expectation is never changed but replaced, so what is saved is what is held: it is in memory once.
    """

    def __init__(
        self,
        level: str,
        system: RlaSystem,
        space: Space,
        transitions: Mapping[tuple[int, int], int],
        saved: Mapping[int, Expectation] | None = None,
        settings: SurpriseSettings | None = None,
    ) -> None:
        """`transitions`: how often each RLA was followed by each other one, as counted up to now.

        `saved`: goes on from these, as far as those RLAs live at this level with the same action. Raises ValueError
        where one of them is of other features.
        """
        self.level = level
        self._system = system
        self._transitions = transitions
        self._settings = settings or SurpriseSettings()
        self._symbols = space.metric != "euclidean"
        weights = np.ones(space.dimensions) if space.weights is None else space.weights
        self._squared_weights = weights * weights
        self._least_usual = max(self._settings.least_usual_share * space.radius, 1e-9)
        self._learned = {
            rla_id: expectation
            for rla_id, expectation in (saved or {}).items()
            if is_valid_for(system, rla_id, expectation, level)
        }
        for rla_id, expectation in self._learned.items():
            values, spreads = len(expectation.mean), len(expectation.squares)
            if not values == spreads == space.dimensions:
                raise ValueError(
                    f"what is expected of RLA {rla_id} has {values} values and {spreads} spreads, "
                    f"its level has {space.dimensions} features"
                )

    def get(self, rla_id: int) -> Expectation | None:
        """What is expected of an RLA now; None for one that was never seen to end."""
        return self._learned.get(rla_id)

    def learn(self, end: End) -> Surprise | None:
        """Take in one end of an RLA; None where too few were seen before to be surprised."""
        rla_id, situation = end.rla_id, end.situation
        rla = self._system.get(rla_id)
        if rla is None:
            return None
        before = self._learned.get(rla_id) or _nothing_yet(rla.origin.command_id, situation)
        if self._symbols:
            deviation = (situation != before.mean).astype(np.float64)
            surprise = self._surprise(before, end, deviation)
            self._learned[rla_id] = _with_symbols(before, deviation, end)
        else:
            deviation = situation - before.mean
            surprise = self._surprise(before, end, deviation)
            self._learned[rla_id] = _with(before, deviation, end)
        return surprise

    def on_event(self, event: TeachingEvent) -> int | None:
        """Forget what is expected of the RLA that an event, already applied, has ended or given another action.

        Returns its id; None where the event changes no action.
        """
        if isinstance(event, LessonUndone | LessonRedone):
            record = self._system.lesson(event.lesson)
            return None if record is None else self._forget(record.event)
        return self._forget(event)

    def snapshot(self) -> dict[int, Expectation]:
        """All of them as they are now: what has not changed since the last call is the same object."""
        return dict(self._learned)

    def _surprise(self, learned: Expectation, end: End, deviation: NDArray[np.float64]) -> Surprise | None:
        count = learned.count
        if count < self._settings.least:
            return None
        # Of symbols a square is 1 or 0: this is the number of places that differ, and how many usually do.
        squared = float(np.add.reduce(self._squared_weights * (deviation * deviation)))
        usual_squared = float(np.add.reduce(self._squared_weights * learned.squares)) / (count - 1)
        distance, usual = (squared, usual_squared) if self._symbols else (math.sqrt(squared), math.sqrt(usual_squared))
        usual = max(usual, self._least_usual)
        seen = self._transitions.get((end.rla_id, end.follow_up), 0)
        surprising = distance > self._settings.beyond * usual
        return Surprise(self.level, end.rla_id, end.follow_up, distance, usual, count, seen, surprising)

    def _forget(self, event: TeachingEvent) -> int | None:
        rla_id = affected_rla(event)
        if rla_id is None:
            return None
        self._learned.pop(rla_id, None)
        return rla_id


def affected_rla(event: TeachingEvent) -> int | None:
    """Id of the RLA whose action an event gives, changes or ends; None where it does nothing of the kind."""
    match event:
        case RlaCreated(rla):
            return rla.rla_id
        case ActionReplaced(rla_id) | ActionWithdrawn(rla_id) | RlaDeleted(rla_id):
            return rla_id
    return None


def valid_expectations(
    system: RlaSystem, saved: Mapping[int, Expectation], levels: Iterable[str]
) -> dict[int, Expectation]:
    """Those of RLAs that live at one of these levels and have the action that they are about."""
    return {
        rla_id: each for rla_id, each in saved.items() if any(is_valid_for(system, rla_id, each, at) for at in levels)
    }


def is_valid_for(system: RlaSystem, rla_id: int, expectation: Expectation, level: str) -> bool:
    """Whether that RLA lives at that level and has the action that the expectation is about."""
    rla = system.get(rla_id)
    return rla is not None and rla.level == level and rla.origin.command_id == expectation.lesson


def _nothing_yet(lesson: str, situation: NDArray[np.float64]) -> Expectation:
    """Before its first end, which is in this situation."""
    return Expectation(lesson, 0, 0.0, pack(situation), bytes(8 * len(situation)))


def _with(before: Expectation, deviation: NDArray[np.float64], end: End) -> Expectation:
    """Welford's way to mean and spread: exact enough however long it goes on, without a list."""
    mean = before.mean + deviation / (before.count + 1)
    return _seen_again(before, mean, before.squares + deviation * (end.situation - mean), end.ticks)


def _with_symbols(before: Expectation, differs: NDArray[np.float64], end: End) -> Expectation:
    """The majority's symbols (Boyer and Moore): one that came less often than all others together gives way."""
    outvoted = (differs > 0) & (2 * before.squares >= before.count)
    mean = np.where(outvoted, end.situation, before.mean)
    return _seen_again(before, mean, before.squares + differs - outvoted, end.ticks)


def _seen_again(
    before: Expectation, mean: NDArray[np.float64], squares: NDArray[np.float64], ticks: int
) -> Expectation:
    count = before.count + 1
    return Expectation(before.lesson, count, before.ticks + (ticks - before.ticks) / count, pack(mean), pack(squares))
