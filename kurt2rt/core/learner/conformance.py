"""Conformance check of a learner: the promises of `Learner`, tried on made-up situations."""

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hal.plugin_frames import place_in_plugin
from kurt2rt.core.learner.learner import Learner, LearnerFactory, LearnerSetting, Why

_LESSONS, _PROBES = 40, 200
_FARTHEST_COUNTS = 500.0


def broken_promises(make: LearnerFactory, setting: LearnerSetting) -> list[str]:
    """Return the promises that a learner breaks, each in a sentence; empty if it keeps all that were tried.

    Args:
        make: returns a new learner of the setting.
        setting: of a task, with at least two actions. Its seed makes the situations.
    """
    check = _Check(make, setting)
    return broken_among(
        (
            ("`decide` returns None before the first lesson", check.asks_at_first),
            ("`decide` names an action of the setting, or None", check.names_actions),
            ("`decide` follows the first lesson in its situation", check.follows_first_lesson),
            ("`decide` changes nothing", check.decides_without_change),
            ("the same lessons give the same decisions", check.is_deterministic),
            ("`restore` gives the decisions of `snapshot`, also after further lessons", check.restores),
            ("`restore` forgets all that is not in the snapshot", check.forgets),
        )
    )


def broken_among(promises: Iterable[tuple[str, Callable[[], bool | str]]]) -> list[str]:
    """Return the promises that do not hold, each in a sentence; one sentence for all that raised the same error.

    An error is told with the file and line of the plug-in. `promises`: each promise with a function that returns
    whether it holds, or else a text that says what happened.
    """
    broken: list[tuple[list[str], str]] = []
    raised: dict[str, list[str]] = {}
    for promise, holds in promises:
        try:
            kept = holds()
        except Exception as error:  # noqa: BLE001 - any error of another author's code is a finding about it
            told = _told(error)
            if told not in raised:
                broken.append((raised.setdefault(told, []), told))
            raised[told].append(promise)
        else:
            if kept is not True:
                broken.append(([promise], kept or "it does not"))
    return [f"{first}{f', and {len(more)} more' if more else ''}: {told}" for (first, *more), told in broken]


def _told(error: Exception) -> str:
    place = place_in_plugin(error)
    return f"raised {type(error).__name__}: {error}" + (f" ({place})" if place else "")


class MadeUp(NamedTuple):
    """Made-up lessons of a setting, as a robot would give them, and situations to try decisions in."""

    situations: NDArray[np.float64]
    """Situations (n, d) of the lessons, in counts."""
    actions: list[str]
    """Actions of the n lessons."""
    probes: NDArray[np.float64]
    """Situations (m, d) to decide in, in counts."""


def made_up(setting: LearnerSetting) -> MadeUp:
    """Return made-up lessons, drawn by the setting's seed."""
    rng = np.random.default_rng(setting.seed)
    # Groups, because lessons of a robot lie together; with noise, so that no two situations are equal.
    centres = rng.uniform(0.0, _FARTHEST_COUNTS, (8, setting.dimensions))
    groups = rng.integers(0, len(centres), _LESSONS + _PROBES)
    situations = centres[groups] + rng.normal(0.0, 5.0, (len(groups), setting.dimensions))
    situations.flags.writeable = False
    actions = [setting.actions[group % len(setting.actions)] for group in groups[:_LESSONS]]
    return MadeUp(situations[:_LESSONS], actions, situations[_LESSONS:])


class _Check:
    """Made-up lessons, as a robot would give them, and situations to try decisions in."""

    def __init__(self, make: LearnerFactory, setting: LearnerSetting) -> None:
        self._make, self._setting = make, setting
        self._situations, self._actions, self._probes = made_up(setting)

    def asks_at_first(self) -> bool:
        return set(self._decisions(self._new(), self._probes[:5])) == {None}

    def names_actions(self) -> bool:
        return set(self._decisions(self._taught(_LESSONS))) <= {None, *self._setting.actions}

    def follows_first_lesson(self) -> bool:
        learner = self._taught(1)
        return {learner.decide(self._situations[0], taught=taught) for taught in (True, False)} == {self._actions[0]}

    def decides_without_change(self) -> bool:
        asked = self._new()
        for place in range(_LESSONS):
            self._teach(asked, place)
            self._decisions(asked, self._probes[:5])
        return self._decisions(asked) == self._decisions(self._taught(_LESSONS))

    def is_deterministic(self) -> bool:
        return self._decisions(self._taught(_LESSONS)) == self._decisions(self._taught(_LESSONS))

    def restores(self) -> bool:
        half = _LESSONS // 2
        taught, restored = self._taught(half), self._new()
        restored.restore(taught.snapshot())
        same = self._decisions(taught) == self._decisions(restored)
        for place in range(half, _LESSONS):
            self._teach(taught, place)
            self._teach(restored, place)
        return same and self._decisions(taught) == self._decisions(restored)

    def forgets(self) -> bool:
        learner, forgot = self._taught(_LESSONS), True
        for lessons in (0, 1, _LESSONS // 2, 2):
            known = self._taught(lessons)
            learner.restore(known.snapshot())
            forgot = forgot and self._decisions(learner) == self._decisions(known)
        return forgot

    def _new(self) -> Learner:
        return self._make(self._setting)

    def _taught(self, lessons: int) -> Learner:
        learner = self._new()
        for place in range(lessons):
            self._teach(learner, place)
        return learner

    def _teach(self, learner: Learner, place: int) -> None:
        why = (Why.ANSWER, Why.CORRECTION, Why.HOLD)[place % 3]
        learner.lesson(self._situations[place], self._actions[place], why)

    def _decisions(self, learner: Learner, probes: NDArray[np.float64] | None = None) -> list[str | None]:
        tried = self._probes if probes is None else probes
        return [learner.decide(probe, taught=taught) for probe in tried for taught in (True, False)]
