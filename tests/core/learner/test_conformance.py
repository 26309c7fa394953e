import inspect

import numpy as np
import pytest
from numpy.typing import NDArray

from kurt2rt.core.learner.conformance import broken_promises
from kurt2rt.core.learner.learner import LearnerSetting, Why
from kurt2rt.core.learner.rla_learner import RlaLearner
from tests.core.learner.helpers import SETTING, Parrot

WIDE = SETTING._replace(dimensions=12, weights=np.ones(12), radius=300.0)


def test_rla_learner_keeps_all_promises() -> None:
    assert broken_promises(RlaLearner, WIDE) == []


def test_restore_of_foreign_bytes_is_refused() -> None:
    with pytest.raises(ValueError, match="char"):
        RlaLearner(WIDE).restore(b"no snapshot")
    with pytest.raises(ValueError, match="reshape"):
        RlaLearner(WIDE).restore(RlaLearner(WIDE).snapshot() + b"12345678")


class Eager(Parrot):
    """Drives before it was taught anything."""

    def decide(self, situation: NDArray[np.float64], *, taught: bool) -> str | None:
        return super().decide(situation, taught=taught) or "a"


class Fickle(Parrot):
    """Decides by the number of its decisions."""

    def decide(self, situation: NDArray[np.float64], *, taught: bool) -> str | None:
        if self.said:
            self.said.append("abc"[len(self.said) % 3])
        return super().decide(situation, taught=taught)


class Hoarder(Parrot):
    """Keeps what it knew in a restore."""

    def restore(self, data: bytes) -> None:
        before = self.said
        super().restore(data)
        self.said += before


class Forgetful(Parrot):
    """Restores nothing."""

    def restore(self, data: bytes) -> None:  # noqa: ARG002 - it looks at nothing
        self.said = []


class Inventive(Parrot):
    """Names an action that does not exist."""

    def lesson(self, situation: NDArray[np.float64], action: str, why: Why) -> None:
        super().lesson(situation, f"{action}!", why)


class Late(Parrot):
    """Follows the lesson before the last."""

    def decide(self, situation: NDArray[np.float64], *, taught: bool) -> str | None:  # noqa: ARG002 - as its parent
        return self.said[-2] if len(self.said) > 1 else None


_MADE: list[int] = []


class Moody(Parrot):
    """Decides by the number of learners that were made."""

    def __init__(self, setting: LearnerSetting) -> None:
        super().__init__(setting)
        _MADE.append(1)
        self._mood = len(_MADE)

    def decide(self, situation: NDArray[np.float64], *, taught: bool) -> str | None:  # noqa: ARG002 - as its parent
        return self.said[-1] if len(self.said) == 1 else "abc"[self._mood % 3] if self.said else None


class Failing(Parrot):
    """Raises an error in its third lesson."""

    def lesson(self, situation: NDArray[np.float64], action: str, why: Why) -> None:
        super().lesson(situation, action, why)
        if len(self.said) == 3:
            raise RuntimeError("full")


@pytest.mark.parametrize(
    ("learner", "promise"),
    [
        (Eager, "`decide` returns None before the first lesson: it does not"),
        (Fickle, "`decide` changes nothing: it does not"),
        (Hoarder, "`restore` forgets all that is not in the snapshot: it does not"),
        (Forgetful, "`restore` gives the decisions of `snapshot`, also after further lessons: it does not"),
        (Inventive, "`decide` names an action of the setting, or None: it does not"),
        (Late, "`decide` follows the first lesson in its situation: it does not"),
        (Moody, "the same lessons give the same decisions: it does not"),
    ],
)
def test_broken_promise_is_named(learner: type[Parrot], promise: str) -> None:
    assert promise in broken_promises(learner, WIDE)


def test_parrot_keeps_all_promises() -> None:
    assert broken_promises(Parrot, WIDE._replace(dimensions=1)) == []


def test_error_of_many_promises_is_told_once_with_its_line() -> None:
    source, first = inspect.getsourcelines(Failing)
    line = first + next(place for place, text in enumerate(source) if "raise" in text)
    (told,) = broken_promises(Failing, WIDE)
    raised = f"raised RuntimeError: full ({__file__}, line {line})"
    assert told == f"`decide` names an action of the setting, or None, and 4 more: {raised}"


class Asking(Parrot):
    """Calls a library with what it does not take."""

    def decide(self, situation: NDArray[np.float64], *, taught: bool) -> str | None:
        return super().decide(situation.reshape(7, 7), taught=taught)


def test_error_in_a_library_is_told_with_the_line_of_its_caller() -> None:
    (told,) = broken_promises(Asking, WIDE)
    assert told.endswith(f"({__file__}, line {inspect.getsourcelines(Asking.decide)[1] + 1})")
