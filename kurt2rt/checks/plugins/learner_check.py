"""Check of a learner: the promises of its door, and the time of its decisions."""

import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from kurt2rt.core.learner.conformance import broken_promises, made_up
from kurt2rt.core.learner.learner import LearnerFactory, LearnerSetting, Why

_TIMED = 50
_TOO_LONG_MS = 20.0
"""Two ticks: the guard refuses a decision that is older, and the robot stands."""


class Finding(NamedTuple):
    """Finding about a plug-in."""

    broken: list[str]
    """Promises that it breaks, each in a sentence."""
    note: str = ""
    """Time of a learner's decisions, in words; empty for another part, and if it breaks promises."""


def check_learner(
    make: LearnerFactory, setting: LearnerSetting, now_ns: Callable[[], int] = time.thread_time_ns
) -> Finding:
    """Return the promises that a learner breaks, and the time that it takes to decide.

    Args:
        make: returns a new learner of the setting.
        setting: of a task, with at least two actions.
        now_ns: processor time of this thread, in ns.
    """
    broken = broken_promises(make, setting)
    return Finding(broken, "" if broken else _time_to_decide(make, setting, now_ns))


def _time_to_decide(make: LearnerFactory, setting: LearnerSetting, now_ns: Callable[[], int]) -> str:
    situations, actions, probes = made_up(setting)
    learner = make(setting)
    for situation, action in zip(situations, actions, strict=True):
        learner.lesson(situation, action, Why.ANSWER)
    times_ms = []
    # The first decision may fit the learner to its lessons, so it is told by itself.
    for probe in probes[: 1 + _TIMED]:
        began_ns = now_ns()
        learner.decide(probe, taught=False)
        times_ms.append((now_ns() - began_ns) / 1e6)
    first_ms, *others_ms = times_ms
    median_ms = float(np.median(others_ms))
    told = (
        f"decide takes {_in_ms(median_ms)} in the median and {_in_ms(max(others_ms))} at most after {len(actions)} "
        f"lessons, and {_in_ms(first_ms)} when it is first asked after them"
    )
    if median_ms <= _TOO_LONG_MS:
        return told
    return (
        f"warning: {told}; a tick is 10 ms, and the guard refuses a decision that is older than {_TOO_LONG_MS:.0f} ms, "
        "so a robot would stand"
    )


def _in_ms(time_ms: float) -> str:
    return f"{time_ms:.2g} ms" if time_ms < 10.0 else f"{time_ms:.0f} ms"
