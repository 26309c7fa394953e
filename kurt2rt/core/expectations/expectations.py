"""Expectations of all RLAs of one level, learned from the situation at each end of an RLA."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.rla.condition import Space
from kurt2rt.core.rla.events import (
    ActionReplaced,
    ActionWithdrawn,
    LessonRedone,
    LessonUndone,
    RlaCreated,
    RlaDeleted,
    TeachingEvent,
)
from kurt2rt.core.rla.lesson_history import LessonHistory
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import Expectation, pack

# Chosen on seeds 0 to 2 of the task streets, so that known ground rarely surprises.
LEAST_ENDS = 5
"""Least number of earlier ends of an RLA."""
BEYOND = 2.0
"""Multiple of the usual distance beyond which an end is surprising."""
LEAST_USUAL_SHARE = 0.05
"""Least usual distance as a share of the radius R, for RLAs whose ends hardly vary."""


class Surprise(NamedTuple):
    """Comparison of an RLA's real end with its expectation, after at least LEAST_ENDS ends.

    `distance` is ||w (situation - mean)||, `usual` the root of the summed weighted variances. It is surprising beyond
    BEYOND times the usual distance. Page and recording show it; it changes no decision.
    """

    level: str
    rla_id: int
    """RLA that ended."""
    follow_up: int
    """RLA that took over."""
    distance: float
    """Distance from the expected to the real situation, weighted as in a match."""
    usual: float
    """Usual distance."""
    ends: int
    """Number of earlier ends of this RLA."""
    seen: int
    """Number of earlier ends with this follow-up."""
    surprising: bool

    @property
    def multiple(self) -> float:
        """Distance as a multiple of the usual one."""
        return self.distance / self.usual

    @property
    def new_follow_up(self) -> bool:
        """Return whether this follow-up is new for the RLA."""
        return self.seen == 0


class End(NamedTuple):
    """End of an RLA's drive, at which `follow_up` took over; the expectations learn from its situation."""

    rla_id: int
    follow_up: int
    situation: NDArray[np.float64]
    """Situation at the end, shape (d,)."""
    ticks: int
    """Duration of the RLA's drive."""


class Expectations:
    """Learner of the situation after each RLA of one level, and of its surprise.

    An `Expectation` is replaced, never changed, so a snapshot shares it.
    """

    def __init__(
        self,
        level: str,
        system: RlaSystem,
        space: Space,
        transitions: Mapping[tuple[int, int], int],
        saved: Mapping[int, Expectation] | None = None,
    ) -> None:
        """Restore the saved expectations whose RLAs are active at this level with the same action.

        `transitions`: (RLA id, follow-up id) -> count, without this tick's. Raises ValueError for a saved
        expectation with another number of features.
        """
        self.level = level
        self._system = system
        self._transitions = transitions
        self._symbols = space.metric != "euclidean"
        weights = np.ones(space.dimensions) if space.weights is None else space.weights
        self._squared_weights = weights * weights
        self._least_usual = max(LEAST_USUAL_SHARE * space.radius, 1e-9)
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
        """Return the expectation of an RLA; None before its first end."""
        return self._learned.get(rla_id)

    def as_taught(self, situation: NDArray[np.float64], image: str) -> NDArray[np.float64]:
        """Return a situation (d,), met by an RLA in an image, as it would look where the RLA was taught."""
        return self._system.images[image].as_taught(situation)

    def learn(self, end: End) -> Surprise | None:
        """Learn one end of an RLA and return its surprise.

        Returns None if the RLA is not active, or if too few ends were learnt before.
        """
        rla_id, situation = end.rla_id, end.situation
        rla = self._system.get(rla_id)
        if rla is None:
            return None
        before = self._learned.get(rla_id) or _empty(rla.origin.command_id, situation)
        if self._symbols:
            deviation = (situation != before.mean).astype(np.float64)
            surprise = self._surprise(before, end, deviation)
            self._learned[rla_id] = _updated_symbols(before, deviation, end)
        else:
            deviation = situation - before.mean
            surprise = self._surprise(before, end, deviation)
            self._learned[rla_id] = _updated(before, deviation, end)
        return surprise

    def forget(self, rla_id: int) -> None:
        """Drop the expectation of an RLA whose action was changed; it may have none."""
        self._learned.pop(rla_id, None)

    def snapshot(self) -> dict[int, Expectation]:
        """Return all expectations by RLA id; unchanged ones are the same objects as in the last call."""
        return dict(self._learned)

    def _surprise(self, learned: Expectation, end: End, deviation: NDArray[np.float64]) -> Surprise | None:
        count = learned.count
        if count < LEAST_ENDS:
            return None
        # Squares of symbols are 1 or 0, so the sums are numbers of different symbols.
        squared = float(np.add.reduce(self._squared_weights * (deviation * deviation)))
        usual_squared = float(np.add.reduce(self._squared_weights * learned.squares)) / (count - 1)
        distance, usual = (squared, usual_squared) if self._symbols else (math.sqrt(squared), math.sqrt(usual_squared))
        usual = max(usual, self._least_usual)
        seen = self._transitions.get((end.rla_id, end.follow_up), 0)
        surprising = distance > BEYOND * usual
        return Surprise(
            level=self.level,
            rla_id=end.rla_id,
            follow_up=end.follow_up,
            distance=distance,
            usual=usual,
            ends=count,
            seen=seen,
            surprising=surprising,
        )


def affected_rla(event: TeachingEvent, history: LessonHistory) -> int | None:
    """Return the id of the RLA whose action an applied event creates, changes or ends; None for other events.

    Its expectation and counted transitions are not valid any more. `history`: lessons that an undo or redo names.
    """
    if isinstance(event, LessonUndone | LessonRedone):
        event = history.event_of(event.lesson)
    match event:
        case RlaCreated(rla):
            return rla.rla_id
        case ActionReplaced(rla_id) | ActionWithdrawn(rla_id) | RlaDeleted(rla_id):
            return rla_id
    return None


def is_valid_for(system: RlaSystem, rla_id: int, expectation: Expectation, level: str) -> bool:
    """Return whether an RLA is active at a level with the action that the expectation was learnt for."""
    rla = system.get(rla_id)
    return rla is not None and rla.level == level and rla.origin.command_id == expectation.lesson


def _empty(lesson: str, situation: NDArray[np.float64]) -> Expectation:
    """Return the expectation before the first end; `situation`: of that end, shape (d,)."""
    return Expectation(lesson, 0, 0.0, pack(situation), bytes(8 * len(situation)))


def _updated(before: Expectation, deviation: NDArray[np.float64], end: End) -> Expectation:
    """Return the expectation after one more end (Welford's algorithm for mean and spread)."""
    mean = before.mean + deviation / (before.count + 1)
    return _replaced(before, mean, before.squares + deviation * (end.situation - mean), end.ticks)


def _updated_symbols(before: Expectation, differs: NDArray[np.float64], end: End) -> Expectation:
    """Return the expectation of symbols after one more end (majority vote of Boyer and Moore)."""
    outvoted = (differs > 0) & (2 * before.squares >= before.count)
    mean = np.where(outvoted, end.situation, before.mean)
    return _replaced(before, mean, before.squares + differs - outvoted, end.ticks)


def _replaced(before: Expectation, mean: NDArray[np.float64], squares: NDArray[np.float64], ticks: int) -> Expectation:
    count = before.count + 1
    return Expectation(before.lesson, count, before.ticks + (ticks - before.ticks) / count, pack(mean), pack(squares))
