"""Each learner of the holds league, held against the definition in its paper."""

from collections.abc import Sequence
from typing import TypeVar

import numpy as np
import pytest
from numpy.typing import NDArray
from sklearn.exceptions import ConvergenceWarning
from sklearn.neural_network import MLPClassifier

from kurt2rt.core.learner.learner import LearnerSetting, Why
from kurt2rt.experiments.rivals.holds import cloning
from kurt2rt.experiments.rivals.holds.cloning import BehaviouralCloning, Ensemble
from kurt2rt.experiments.rivals.holds.dagger import Dagger
from kurt2rt.experiments.rivals.holds.eil import BORDER, Eil, cost_slopes
from kurt2rt.experiments.rivals.holds.ensemble_dagger import EnsembleDagger
from kurt2rt.experiments.rivals.holds.hg_dagger import HgDagger
from kurt2rt.experiments.rivals.holds.hold_learner import HoldLearner
from kurt2rt.experiments.rivals.holds.iwr import Iwr
from kurt2rt.experiments.rivals.holds.network import HIDDEN, Classifier, epochs_of
from kurt2rt.experiments.rivals.holds.safe_dagger import LazyDagger, SafeDagger
from kurt2rt.experiments.rivals.holds.thrifty_dagger import ThriftyDagger

L = TypeVar("L", bound=HoldLearner)
E = TypeVar("E", bound=Ensemble)
SETTING = LearnerSetting(2, np.ones(2), 10.0, 0.5, 0.1, ("a", "b", "c"), 1)
LEFT, RIGHT, NEW = np.array([0.0, 0.0]), np.array([40.0, 0.0]), np.array([20.0, 60.0])


def taught(learner: L, *, mixed: bool = False) -> L:
    """Teach a at the left and b at the right, each ten times; `mixed`: also a and b in turn far from both."""
    rng = np.random.default_rng(5)
    for number in range(10):
        learner.lesson(LEFT + rng.normal(0.0, 1.0, 2), "a", Why.HOLD)
        learner.lesson(RIGHT + rng.normal(0.0, 1.0, 2), "b", Why.HOLD)
        if mixed:
            learner.lesson(NEW + rng.normal(0.0, 1.0, 2), "ab"[number % 2], Why.HOLD)
    learner.refit()
    return learner


class Chances:
    """Network whose probabilities are written by hand."""

    def __init__(self, chances: Sequence[float]) -> None:
        self._chances = np.array(chances)

    def probabilities(self, point: NDArray[np.float64]) -> NDArray[np.float64]:  # noqa: ARG002 - the same everywhere
        return self._chances


def ensemble_of(kind: type[E], *rows: Sequence[float], gate: float | None = None) -> E:
    """Return a fitted ensemble with a member for each row of probabilities."""
    learner = kind(SETTING._replace(gate=gate))
    learner.members = [Chances(row) for row in rows]  # type: ignore[misc]
    learner.iteration = 1
    return learner


@pytest.mark.parametrize("classes", [2, 3])
def test_network_of_few_points_tells_classes_apart(classes: int) -> None:
    rng = np.random.default_rng(4)
    said = np.arange(30) % classes
    points = rng.normal(0.0, 1.0, (30, 4)) + 6.0 * said[:, None]
    found = Classifier(points, said, classes, 9, few=True)
    assert [int(found.probabilities(each).argmax()) for each in points] == said.tolist()


@pytest.mark.parametrize("classes", [2, 3])
def test_network_has_the_probabilities_of_the_library(classes: int) -> None:
    rng = np.random.default_rng(3)
    points, said = rng.normal(0.0, 3.0, (60, 4)), rng.integers(0, classes, 60)
    scaled = (points - points.mean(axis=0)) / points.std(axis=0)
    theirs = MLPClassifier(HIDDEN, alpha=1e-4, batch_size=60, max_iter=epochs_of(60), random_state=9)
    with pytest.warns(ConvergenceWarning):
        theirs.fit(scaled, said)
    ours = Classifier(points, said, classes, 9)
    assert np.allclose([ours.probabilities(each) for each in points], theirs.predict_proba(scaled), atol=1e-9)


def test_bc_ignores_what_no_teacher_named() -> None:
    learner = taught(BehaviouralCloning(SETTING))
    learner.lesson(LEFT, "c", Why.DROVE)
    learner.refit()
    assert learner.decide(LEFT, taught=True) == "a"
    assert learner.act(LEFT)[2] == 0.0


def test_dagger_mixes_by_powers_of_0_7() -> None:
    learner = Dagger(SETTING)
    learner.lesson(LEFT, "a", Why.HOLD)
    betas = []
    for _ in range(4):
        betas.append(learner.beta)
        learner.refit()
    assert betas == pytest.approx([1.0, 0.7, 0.49, 0.343])
    assert learner.drives_by_teacher(0.24)
    assert not learner.drives_by_teacher(0.2402)  # 0.7^4 = 0.2401
    learner.advised = "c"
    assert learner.decide(LEFT, taught=True) == "c"


def test_hg_dagger_threshold_is_the_mean_of_the_last_quarter(monkeypatch: pytest.MonkeyPatch) -> None:
    learner = ensemble_of(HgDagger, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    assert learner.doubt(LEFT) == pytest.approx(np.hypot(0.25, 0.25))
    doubts = iter([9.0, 9.0, 9.0, 9.0, 9.0, 9.0, 2.0, 4.0])
    monkeypatch.setattr(learner, "doubt", lambda _: next(doubts))
    for _ in range(8):
        learner.on_takeover(LEFT)
    assert learner.doubt_threshold == pytest.approx(3.0)
    assert not learner.asks(LEFT)


def test_safe_dagger_asks_where_labels_differ_from_its_policy() -> None:
    learner = taught(SafeDagger(SETTING), mixed=True)
    assert learner.asks(NEW)
    assert not learner.asks(LEFT)
    assert (learner.is_ready(LEFT, 0), learner.is_ready(NEW, 0)) == (True, False)
    assert learner.decide(NEW, taught=True) is None
    assert learner.decide(NEW, taught=False) in ("a", "b")


def test_lazy_dagger_gives_back_at_a_tenth_of_its_threshold() -> None:
    learner = LazyDagger(SETTING._replace(gate=0.6))
    for chance, ready in ((0.93, False), (0.95, True)):
        learner.policy = Chances((chance, 1.0 - chance, 0.0))  # type: ignore[assignment]
        learner.safety = Chances((0.8, 0.2))  # type: ignore[assignment]
        assert not learner.asks(LEFT)
        assert learner.is_ready(LEFT, 0) is ready


def test_ensemble_dagger_needs_both_rules_to_go_on() -> None:
    sure = ensemble_of(EnsembleDagger, (0.9, 0.1, 0.0), (0.8, 0.2, 0.0))
    assert sure.doubt(LEFT) == pytest.approx(2 * 0.0025)
    assert (sure.asks(LEFT), sure.is_ready(LEFT, 0), sure.is_ready(LEFT, 1)) == (False, True, False)
    torn = ensemble_of(EnsembleDagger, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    assert (torn.asks(LEFT), torn.is_ready(LEFT, 0)) == (True, False)
    assert not ensemble_of(EnsembleDagger, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), gate=0.6).asks(LEFT)


def test_thrifty_dagger_asks_as_often_as_its_budget(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cloning, "MEMBERS", 2)
    learner = taught(ThriftyDagger(SETTING._replace(gate=0.25)), mixed=True)
    rng = np.random.default_rng(2)
    met = [np.array([x, y]) for x, y in rng.uniform((-10.0, -10.0), (50.0, 70.0), (40, 2))]
    learner.fits_at_intervals = True
    for place in met:
        learner.lesson(place, learner.decide(place, taught=False) or "", Why.DROVE)
    learner.refit()
    assert learner.novel_beyond == pytest.approx(np.quantile([learner.novelty(each) for each in met], 0.75))
    assert learner.risky_beyond == pytest.approx(np.quantile([learner.risk(each) for each in met], 0.75))
    assert learner.safe_within == pytest.approx(np.median([learner.risk(each) for each in met]))
    assert sum(learner.novelty(each) > learner.novel_beyond for each in met) == 10


def test_thrifty_dagger_finds_risk_before_trouble(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cloning, "MEMBERS", 2)
    learner = taught(ThriftyDagger(SETTING))
    learner.fits_at_intervals = True
    for _ in range(20):
        for place, action in ((LEFT, "a"), (RIGHT, "b")):
            learner.lesson(place, action, Why.DROVE)
            learner.on_takeover(place)
        learner.lesson(NEW, "b", Why.DROVE)
        learner.on_trouble()
    learner.refit()
    assert learner.risk(LEFT) < 0.2
    learner.members = [Chances((0.0, 1.0, 0.0))]  # type: ignore[list-item]
    assert learner.risk(NEW) > 0.8


def test_iwr_gives_interventions_half_of_the_weight() -> None:
    weights = Iwr.weights(np.array([True, False, False, False]))
    assert weights.tolist() == pytest.approx([2.0, 2 / 3, 2 / 3, 2 / 3])
    assert Iwr.weights(np.array([False, False])).tolist() == [1.0, 1.0]


def test_iwr_learns_its_own_drive_but_not_what_was_overruled() -> None:
    learner = taught(Iwr(SETTING))
    for _ in range(10):
        learner.lesson(NEW, "c", Why.DROVE)
        learner.lesson(NEW, "b", Why.OVERRULED)
    learner.lesson(LEFT, "a", Why.HOLD)
    learner.refit()
    assert learner.decide(NEW, taught=True) == "c"


def test_eil_slopes_are_those_of_its_three_losses() -> None:
    costs = np.array([[BORDER + 0.5, -1.0], [BORDER - 0.5, -1.0], [BORDER - 0.5, 0.0], [BORDER + 0.5, 0.0]])
    whys = np.array([Why.DROVE, Why.DROVE, Why.OVERRULED, Why.OVERRULED])
    slopes = cost_slopes(costs, np.zeros(4, dtype=np.int64), whys)
    assert slopes.tolist() == [[1.0, 0.0], [0.0, 0.0], [-1.0, 0.0], [0.0, 0.0]]
    told = cost_slopes(np.array([[1.0, 1.0]]), np.array([0]), np.array([Why.HOLD]))
    assert told.tolist() == [[0.5, -0.5]]  # the log loss of -Q: the teacher's action gets cheaper


def test_eil_turns_away_from_what_was_overruled() -> None:
    learner = taught(Eil(SETTING))
    usual = learner.decide(NEW, taught=True)
    assert usual is not None
    for _ in range(30):
        learner.lesson(NEW, usual, Why.OVERRULED)
        learner.lesson(LEFT, "a", Why.DROVE)
    learner.refit()
    assert learner.decide(NEW, taught=True) != usual
    assert learner.decide(LEFT, taught=True) == "a"


@pytest.mark.parametrize("kind", [BehaviouralCloning, Eil, Iwr])
def test_learner_that_is_fitted_at_intervals_waits_for_it(kind: type[HoldLearner]) -> None:
    learner = kind(SETTING)
    learner.fits_at_intervals = True
    learner.lesson(LEFT, "a", Why.HOLD)
    assert learner.decide(LEFT, taught=True) is None
    learner.refit()
    assert learner.decide(LEFT, taught=True) == "a"
    learner.stands = True
    assert learner.decide(LEFT, taught=True) is None
