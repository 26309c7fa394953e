"""Every learner of the project keeps the promises, and does what its name says."""

from collections.abc import Sequence

import numpy as np
import pytest
from sklearn.ensemble import RandomForestClassifier
from sklearn.svm import SVC

from kurt2rt.core.learner.conformance import broken_promises
from kurt2rt.core.learner.learner import Learner, LearnerSetting, Why
from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.lockstep.learner_setting import learner_setting
from kurt2rt.experiments.rivals.holds.rows import TARGETS as HOLDS
from kurt2rt.experiments.rivals.learners.flat_trees import FlatTrees
from kurt2rt.experiments.rivals.learners.support_vectors import PairVotes
from kurt2rt.experiments.rivals.registry import find_learner, learner_names
from kurt2rt.experiments.rivals.signals.rows import TARGETS as SIGNALS
from tests.experiments.helpers import ROBOT

SETTING = learner_setting(load_task("wall_following"), ROBOT, seed=7)
FLAT = LearnerSetting(2, np.ones(2), 10.0, 0.5, 0.1, ("a", "b", "c"), 1)
NEVER_ASK = ("1-nn", "tree", "vote-without-gate", "vote-asks-at-random")
SLOWLY_FITTED = (*HOLDS, "mlp-ensemble", "forest", "arf", "svm", "hoeffding")
"""Learners whose check takes seconds, because it fits them forty times and more."""
PRESSED = [name for name in learner_names() if name not in (*HOLDS, *SIGNALS)]
"""Learners that learn by presses; those of holds and of rewards act where no teacher is."""


def taught(name: str, *labels: tuple[float, float, str], setting: LearnerSetting = FLAT) -> Learner:
    learner = find_learner(name)(setting)
    for x, y, action in labels:
        learner.lesson(np.array([x, y]), action, Why.ANSWER)
    return learner


def says(learner: Learner, x: float, y: float, *, teacher: bool = False) -> str | None:
    return learner.decide(np.array([x, y]), taught=teacher)


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[pytest.mark.deep] if name in SLOWLY_FITTED else []) for name in learner_names()],
)
def test_each_learner_keeps_all_promises(name: str) -> None:
    assert broken_promises(find_learner(name), SETTING) == []


GROUPS: Sequence[tuple[float, float, str]] = [
    (place + shift, shift, action)
    for place, action in ((0.0, "a"), (40.0, "b"))
    for shift in (-1.0, -0.5, 0.0, 0.5, 1.0)
]
"""Five labels each around two places, farther apart than R."""


@pytest.mark.parametrize("name", [name for name in learner_names() if name not in SIGNALS])
def test_each_learner_tells_two_groups_apart(name: str) -> None:
    learner = taught(name, *GROUPS)
    assert (says(learner, 0.2, 0.2), says(learner, 40.2, 0.2)) == ("a", "b")


@pytest.mark.parametrize("name", [name for name in PRESSED if name not in NEVER_ASK])
def test_learner_with_a_gate_asks_far_from_all_labels(name: str) -> None:
    learner = taught(name, *GROUPS)
    assert says(learner, 500.0, 500.0) is None
    assert says(learner, 0.0, -9.0, teacher=True) is None  # inside R, beyond half of it


@pytest.mark.parametrize("name", NEVER_ASK)
def test_learner_without_a_gate_never_asks_again(name: str) -> None:
    learner = taught(name, *GROUPS)
    assert says(learner, 500.0, 500.0) is not None


@pytest.mark.parametrize("name", ["k-nn", "weighted-vote"])
def test_gate_of_neighbours_is_a_multiple_of_r(name: str) -> None:
    near, wide = taught(name, *GROUPS), taught(name, *GROUPS, setting=FLAT._replace(gate=3.0))
    assert (says(near, 0.0, 20.0), says(wide, 0.0, 20.0)) == (None, "a")


def test_gp_gate_is_a_variance() -> None:
    # Of a single label the variance is 1 - exp(-distance² / R²) / 1.05.
    learner = taught("gp", (0.0, 0.0, "a"), setting=FLAT._replace(gate=0.5))
    assert says(learner, 8.0, 0.0) == "a"  # 0.498
    assert says(learner, 8.1, 0.0) is None  # 0.506


@pytest.mark.parametrize("name", ["svm", "forest", "hoeffding", "arf"])
def test_gate_of_votes_asks_between_two_actions(name: str) -> None:
    mixed = [(x, y, "ab"[(i + j) % 2]) for i, x in enumerate((0.0, 1.0, 2.0)) for j, y in enumerate((0.0, 1.0, 2.0))]
    gate = 1.9 if name == "svm" else 0.95
    strict, lax = (taught(name, *mixed, setting=FLAT._replace(gate=each)) for each in (gate, 0.0))
    assert says(strict, 0.5, 0.5) is None
    assert says(lax, 0.5, 0.5) in ("a", "b")


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


def test_rlas_within_r_outvote_a_nearer_one() -> None:
    labels = [*GROUPS, (0.2, 0.2, "c"), (9.0, 9.0, "b")]
    assert says(taught("rla-door", *labels), 0.2, 0.2) == "c"
    voting = taught("rla-vote", *labels)
    assert says(voting, 0.2, 0.2) == "a"
    assert says(voting, 9.0, 9.0) == "b"


def test_svm_of_rlas_outvotes_a_single_wrong_one() -> None:
    grid = [(float(x), float(y), "a") for x in (-2, -1, 0, 1, 2) for y in (-2, -1, 1, 2)]
    labels = [*grid, (40.0, 0.0, "b"), (0.1, 0.1, "b")]
    assert says(taught("rla-door", *labels), 0.1, 0.1) == "b"
    machine = taught("rla-svm", *labels)
    assert [says(machine, *place) for place in ((0.1, 0.1), (40.0, 0.0), (100.0, 0.0))] == ["a", "b", None]


@pytest.mark.parametrize("classes", [2, 3, 6])
def test_pair_votes_are_those_of_scikit_learn(classes: int) -> None:
    rng = np.random.default_rng(classes)
    points, actions = rng.normal(size=(60, 8)), rng.integers(0, classes, 60).astype(str)
    machine = SVC(C=10.0, gamma=0.1, decision_function_shape="ovr").fit(points, actions)
    votes, probes = PairVotes(machine, 0.1), rng.normal(size=(50, 8))
    found, theirs = np.array([votes.values(probe) for probe in probes]), machine.decision_function(probes)
    assert np.allclose(found[:, 1] - found[:, 0] if classes == 2 else found, theirs, rtol=0.0, atol=1e-9)


def test_flat_trees_have_the_shares_of_the_forest() -> None:
    rng = np.random.default_rng(3)
    points, actions = rng.uniform(0.0, 500.0, (120, 72)), rng.choice(list("abcde"), 120)
    forest = RandomForestClassifier(20, random_state=1).fit(points, actions)
    flat, probes = FlatTrees(forest.estimators_), rng.uniform(0.0, 500.0, (50, 72))
    found = np.array([flat.shares(probe) for probe in probes])
    assert np.allclose(found, forest.predict_proba(probes), rtol=0.0, atol=1e-12)
