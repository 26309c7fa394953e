"""Equal tuning: each rival has its own search, and the league takes what it found."""

import json
from pathlib import Path

import pytest
from pydantic import ValidationError

from hal.settings import SettingsError
from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.rivals.registry import learner_names
from kurt2rt.experiments.rivals.rival import SHIPPED, TUNED, Rival
from kurt2rt.experiments.rivals.tuned import TunedRival, load_tuned
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.results import Results
from kurt2rt.experiments.tuning.settings import TuningSettings, load_tuning
from kurt2rt.experiments.tuning.tuned_file import write_tuned
from kurt2rt.experiments.tuning.tuning import plan_tuning
from tests.experiments.helpers import ROBOT, STAGE
from tests.experiments.search.tiny import SHORT, tiny_settings
from tests.experiments.study.here import HERE

TASK = "wall_following"
SHIPPED_TUNING = load_tuning("presses")


def tiny_tuning() -> TuningSettings:
    seeds = SHIPPED_TUNING.seeds.model_copy(update={"count": 1})
    return SHIPPED_TUNING.model_copy(update={"seeds": seeds, "worlds": {TASK: ("a",)}})


def parts(folder: Path) -> JobParts:
    return JobParts(factory=STAGE, robot=ROBOT, results=Results(folder))


def test_each_gate_is_of_a_learner_of_the_project() -> None:
    assert set(SHIPPED_TUNING.gates) <= set(learner_names())


@pytest.mark.parametrize("task", SHIPPED_TUNING.worlds)
def test_searches_of_all_rivals_differ_in_own_keys_only(task: str) -> None:
    searches = {rival: SHIPPED_TUNING.search(task, rival, 40) for rival in SHIPPED_TUNING.rivals}
    assert len({(each.search, each.trials, each.teacher, each.objective) for each in searches.values()}) == 1
    assert {len(each.space) for each in searches.values()} == {3}
    assert [rival for rival, each in searches.items() if each.learner is None] == [TUNED]


def test_tuning_goes_on_and_its_file_has_the_best_trial(tmp_path: Path) -> None:
    tuning = tiny_tuning()
    found = []
    for trials in (1, 2):
        planned = plan_tuning(tuning, TASK, "k-nn", parts(tmp_path), trials, SHORT)
        found.append(planned.run(HERE, lambda _: None))
    taught = sorted((tmp_path / TASK / "k-nn").glob("results/trials/*/*.json"))
    assert [each.parent.name for each in taught] == ["0000", "0001"]
    assert found[0].values == {"learning.radius": 900.0, "learning.asks_beyond_share": 0.55, "gate": 1.0}
    assert found[1].score >= found[0].score == found[1].first_score
    path = tmp_path / "tuned.yaml"
    write_tuned(tuning, 2, found[1:], planned.plan.made_of, "kurt2rt tune presses", path)
    assert load_tuned(str(path)).of(TASK, "k-nn") == found[1]
    assert load_tuned(str(path)).of(TASK, "gp") is None


def test_tuned_rival_has_the_numbers_of_its_best_trial() -> None:
    values = {"learning.radius": 500.0, "learning.asks_beyond_share": 0.4, "gate": 0.7}
    found = TunedRival(task=TASK, rival="k-nn", values=values, trial=3, score=1.0, first_score=0.5)
    rival, task = Rival("k-nn").tuned_by(found), load_task(TASK)
    learning = rival.task(task).learning
    assert (learning.radius, learning.asks_beyond_share, rival.gate) == (500.0, 0.4, 0.7)
    assert learning.weights == task.learning.weights
    assert rival.label != Rival("k-nn").label
    # A gate that was typed stays.
    assert Rival("k-nn", 0.9).tuned_by(found).gate == 0.9
    assert Rival(SHIPPED).tuned_by(None) == Rival(SHIPPED)


def test_shipped_settings_lie_within_what_was_searched() -> None:
    shipped = load_tuned("presses")
    assert shipped.seeds == f"{SHIPPED_TUNING.seeds.seeds[0]}-{SHIPPED_TUNING.seeds.seeds[-1]}"
    for each in shipped.rivals:
        search = SHIPPED_TUNING.search(each.task, each.rival, shipped.trials)
        assert set(each.values) == {dimension.key for dimension in search.space}
        assert all(dimension.low <= each.values[dimension.key] <= dimension.high for dimension in search.space)
        assert 0 <= each.trial < shipped.trials
        assert each.score >= each.first_score


def test_search_of_a_gate_needs_its_learner(tmp_path: Path) -> None:
    learner = {"name": "k-nn", "gate": 1.0}
    space = [{"key": "gate", "low": 0.5, "high": 1.5}]
    assert tiny_settings(tmp_path, learner=learner, space=space).learner is not None
    with pytest.raises(SettingsError, match="no learner is named"):
        tiny_settings(tmp_path, space=space)


def test_task_or_rival_that_is_not_tuned_is_named() -> None:
    with pytest.raises(SettingsError, match="the task circle is not tuned"):
        SHIPPED_TUNING.search("circle", "k-nn", 1)
    with pytest.raises(SettingsError, match="tree is not tuned"):
        SHIPPED_TUNING.search(TASK, "tree", 1)


@pytest.mark.parametrize("name", ["bc", "tamer"])
def test_learner_of_another_league_is_refused(name: str, tmp_path: Path) -> None:
    tuning = tiny_tuning().model_copy(update={"gates": {name: SHIPPED_TUNING.gates["k-nn"]}})
    with pytest.raises(SettingsError, match=f"{name} is not taught by presses"):
        plan_tuning(tuning, TASK, name, parts(tmp_path), 1, SHORT)


def test_report_seeds_are_refused_for_tuning() -> None:
    content = SHIPPED_TUNING.model_dump(mode="json")
    content["seeds"]["first"] = 4106
    with pytest.raises(ValidationError, match="4106 is for reports"):
        TuningSettings.model_validate_json(json.dumps(content)).search(TASK, "k-nn", 1)
