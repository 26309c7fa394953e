"""Every learner of the project keeps the promises, and does what its name says."""

from collections.abc import Sequence

import numpy as np
import pytest

from kurt2rt.checks.plugins.learner_tests import LearnerTests
from kurt2rt.core.learner.learner import Learner, LearnerSetting, Why
from kurt2rt.core.learner.learners import find_learner, learner_names

FLAT = LearnerSetting(2, np.ones(2), 10.0, 0.5, 0.1, ("a", "b", "c"), 1)
NEVER_ASK = ("1-nn", "tree")


def taught(name: str, *labels: tuple[float, float, str], setting: LearnerSetting = FLAT) -> Learner:
    learner = find_learner(name)(setting)
    for x, y, action in labels:
        learner.lesson(np.array([x, y]), action, Why.ANSWER)
    return learner


def says(learner: Learner, x: float, y: float, *, teacher: bool = False) -> str | None:
    return learner.decide(np.array([x, y]), taught=teacher)


class TestPromises(LearnerTests):
    """Each learner keeps the promises of all."""

    @pytest.fixture(
        autouse=True,
        params=[
            pytest.param(name, marks=[pytest.mark.deep] if name in ("svm", "tree") else []) for name in learner_names()
        ],
    )
    def named(self, request: pytest.FixtureRequest) -> None:
        self.name = str(request.param)

    def make(self, setting: LearnerSetting) -> Learner:
        return find_learner(self.name)(setting)


GROUPS: Sequence[tuple[float, float, str]] = [
    (place + shift, shift, action)
    for place, action in ((0.0, "a"), (40.0, "b"))
    for shift in (-1.0, -0.5, 0.0, 0.5, 1.0)
]
"""Five labels each around two places, farther apart than R."""


@pytest.mark.parametrize("name", learner_names())
def test_each_learner_tells_two_groups_apart(name: str) -> None:
    learner = taught(name, *GROUPS)
    assert (says(learner, 0.2, 0.2), says(learner, 40.2, 0.2)) == ("a", "b")


@pytest.mark.parametrize("name", [name for name in learner_names() if name not in NEVER_ASK])
def test_learner_with_a_gate_asks_far_from_all_labels(name: str) -> None:
    learner = taught(name, *GROUPS)
    assert says(learner, 500.0, 500.0) is None
    assert says(learner, 0.0, -9.0, teacher=True) is None  # inside R, beyond half of it


@pytest.mark.parametrize("name", ["k-nn", "weighted-vote"])
def test_gate_of_neighbours_is_a_multiple_of_r(name: str) -> None:
    near, wide = taught(name, *GROUPS), taught(name, *GROUPS, setting=FLAT._replace(gate=3.0))
    assert (says(near, 0.0, 20.0), says(wide, 0.0, 20.0)) == (None, "a")


@pytest.mark.parametrize("actions", ["ab", "abc"])
def test_margin_of_the_svm_asks_between_actions(actions: str) -> None:
    mixed = [
        (x, y, actions[(i + j) % len(actions)])
        for i, x in enumerate((0.0, 1.0, 2.0))
        for j, y in enumerate((0.0, 1.0, 2.0))
    ]
    strict, lax = (taught("svm", *mixed, setting=FLAT._replace(gate=each)) for each in (1.9, 0.0))
    assert says(strict, 0.5, 0.5) is None
    assert says(lax, 0.5, 0.5) in set(actions)


def test_svm_of_one_action_knows_what_is_near() -> None:
    only = taught("svm", (0.0, 0.0, "a"))
    assert (says(only, 1.0, 0.0), says(only, 11.0, 0.0)) == ("a", None)


def test_nearest_neighbour_takes_the_newest_of_equal_labels() -> None:
    assert says(taught("1-nn", (0.0, 0.0, "a"), (5.0, 0.0, "b"), (0.0, 0.0, "c")), 0.0, 0.0) == "c"


def test_k_nearest_outvotes_a_single_wrong_label() -> None:
    labels = [*GROUPS, (0.2, 0.2, "c")]
    assert says(taught("k-nn", *labels), 0.2, 0.2) == "a"
    assert says(taught("1-nn", *labels), 0.2, 0.2) == "c"


def test_weighted_vote_follows_the_near_label_of_many() -> None:
    labels = [(9.0, 0.0, "b")] * 9 + [(0.0, 0.0, "a")]
    assert says(taught("weighted-vote", *labels), 1.0, 0.0) == "a"
    assert says(taught("k-nn", *labels), 1.0, 0.0) == "b"
