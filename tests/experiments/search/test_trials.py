"""Trials: the same at every run, in any number of processes, and after any interruption."""

from pathlib import Path
from typing import Any, NamedTuple

import pytest
from optuna.trial import TrialState

from kurt2rt.experiments.search import trials as trials_module
from kurt2rt.experiments.search.plan import SearchPlan
from kurt2rt.experiments.search.trials import SearchTrials, run_trials
from kurt2rt.experiments.study import provenance
from kurt2rt.experiments.study.jobs import StudyError
from kurt2rt.experiments.study.pool import Waves, open_processes, run_missing
from tests.experiments.search.tiny import tiny_plan
from tests.experiments.study.here import HERE

Trial = tuple[dict[str, Any], TrialState, float | None, dict[int, float]]


def trials_of(found: SearchTrials) -> list[Trial]:
    return [(each.params, each.state, each.value, each.intermediate_values) for each in found.all]


def run(plan: SearchPlan) -> list[Trial]:
    with plan.parts["results"].held():
        return trials_of(run_trials(plan, 3, HERE, lambda _: None))


class Whole(NamedTuple):
    """A search that was never interrupted."""

    plan: SearchPlan
    trials: list[Trial]


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Whole:
    plan = tiny_plan(tmp_path_factory.mktemp("whole"))
    return Whole(plan, run(plan))


@pytest.fixture
def whole(finished: Whole) -> list[Trial]:
    return finished.trials


@pytest.mark.deep
def test_search_in_two_processes_has_the_same_trials(whole: list[Trial], tmp_path: Path) -> None:
    plan = tiny_plan(tmp_path)
    with plan.parts["results"].held(), open_processes(2) as executor:
        assert trials_of(run_trials(plan, 3, executor, lambda _: None)) == whole


class _Stop:
    left = 0


def test_search_interrupted_between_robots_goes_on(
    whole: list[Trial], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stop = _Stop()
    stop.left = 3

    def stopping(waves: Waves, *others: Any) -> None:
        if not stop.left:
            raise InterruptedError
        stop.left -= 1
        run_missing(waves, *others)

    monkeypatch.setattr(trials_module, "run_missing", stopping)
    with pytest.raises(InterruptedError):
        run(tiny_plan(tmp_path))
    stop.left = 100
    assert run(tiny_plan(tmp_path)) == whole


def test_results_of_another_search_are_refused(finished: Whole, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = finished.plan.folder.parent
    with pytest.raises(StudyError, match=r"what differs: task\)"):
        run(tiny_plan(folder, sampler_seed=1))
    monkeypatch.setattr(provenance, "source_hash", lambda: "new")
    with pytest.raises(StudyError, match=r"what differs: source\)"):
        run(tiny_plan(folder))


def test_trial_that_cannot_beat_the_median_is_pruned(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plan = tiny_plan(tmp_path)
    monkeypatch.setattr(SearchTrials, "median_score", lambda _self, first: 2.0 if first else -1.0)
    found = run(plan)
    assert [state for _, state, *_ in found] == [TrialState.COMPLETE] * 2 + [TrialState.PRUNED]
    assert list(found[2][3]) == [0]
    assert len(list((plan.folder / "results/trials/0002").iterdir())) == 1


def test_median_is_of_four_earlier_trials_at_least(tmp_path: Path) -> None:
    found = SearchTrials(tiny_plan(tmp_path))
    for number, score in enumerate((0.1, 0.4, 0.2, 0.3, 0.9)):
        found.begin(number)
        found.study.tell(number, score)
    assert found.median_score(3) == float("-inf")
    assert found.median_score(4) == pytest.approx(0.25)
    assert found.median_score(5) == pytest.approx(0.3)
