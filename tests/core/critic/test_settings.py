"""The critic's settings: the shipped ones, and what is refused."""

import json
from pathlib import Path
from typing import Any

import pytest

from hal.settings import SettingsError, load_settings
from kurt2rt.core.critic.settings import NAMES, SURPRISED, AppraisalWeights, CriticSettings, load_critic
from kurt2rt.core.task_settings import load_task

CONTENT: dict[str, Any] = load_critic().model_dump(mode="json")


def changed(section: str, **values: object) -> dict[str, Any]:
    return CONTENT | {section: CONTENT[section] | values}


def checked(content: dict[str, Any]) -> CriticSettings:
    return CriticSettings.model_validate_json(json.dumps(content))


def test_the_shipped_critic_thinks_bad_neutral_or_good() -> None:
    assert load_critic().values == {"bad": -1, "neutral": 0, "good": 1}


@pytest.mark.parametrize("name", ["eight", "fleeing"])
def test_the_critics_of_other_tasks_look_at_the_same_and_differ_in_what_counts(name: str) -> None:
    basic, other = load_critic(), load_critic(name)
    same = {"name": basic.name, "learning": basic.learning}
    assert other.model_copy(update=same) == basic
    assert other.learning.model_copy(update={"weights": basic.learning.weights}) == basic.learning
    assert load_task(name).critic == name


def test_a_name_that_is_not_there_is_told() -> None:
    with pytest.raises(
        SettingsError, match=r"no such file in critics; give a path to a \.yaml file or one of: basic, eight"
    ):
        load_critic("stern")


def test_appraisals_are_bound_to_what_the_circumstances_are_and_to_nothing_else() -> None:
    bound = load_critic().level_features
    assert bound.feature_names == NAMES
    assert bound.feature_hash == load_critic().feature_hash
    for same in (changed("agreement", bound=0.5), changed("learning", radius=3.0), changed("best", margin=0.5)):
        assert checked(same).level_features == bound
    for other in (changed("perception", smoothing_s=0.7), changed("perception", wall_m=0.5)):
        assert checked(other).level_features.feature_hash != bound.feature_hash


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (changed("learning", weights={"left_m": 0.0}), "every circumstance weighs 0; give one more"),
        (changed("agreement", least=31), r"least is 31, allowed is at most window \(30\)"),
        (CONTENT | {"appraisals": CONTENT["appraisals"][:2]}, "one of value -1 and one of value 1"),
        (CONTENT | {"appraisals": CONTENT["appraisals"] * 2}, "bad, good, neutral stands twice"),
    ],
)
def test_what_makes_no_sense_is_refused(content: dict[str, Any], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        checked(content)


def test_each_circumstance_may_be_weighed_and_nothing_else(tmp_path: Path) -> None:
    assert set(AppraisalWeights.model_fields) == {*NAMES, SURPRISED}
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text(json.dumps(changed("learning", weights={"lift_m": 1.0})))
    with pytest.raises(SettingsError, match=r"weights.lift_m: no such key; allowed here: left_m, front_m, right_m"):
        load_critic(str(wrong))


def test_a_critic_of_ones_own_may_know_more(tmp_path: Path) -> None:
    mine = tmp_path / "mine.yaml"
    long = {"name": "bad_for_long", "value": -1, "trace_s": 3.0}
    mine.write_text(json.dumps(CONTENT | {"appraisals": [*CONTENT["appraisals"], long]}))
    assert load_settings(mine, CriticSettings).values["bad_for_long"] == -1
    assert load_critic(str(mine)).weight_vector.shape == (len(NAMES),)


def test_surprise_is_a_feature_of_those_that_hold_it_and_of_no_others() -> None:
    shipped = load_critic()
    content = json.loads(shipped.model_dump_json())
    content["perception"]["surprise_held_s"] = 1.0
    content["learning"]["weights"]["surprised"] = 2.0
    surprised = CriticSettings.model_validate_json(json.dumps(content))
    assert (shipped.names, surprised.names) == (NAMES, (*NAMES, SURPRISED))
    assert surprised.weight_vector.tolist() == [*shipped.weight_vector.tolist(), 2.0]
    assert surprised.feature_hash != shipped.feature_hash
    del content["perception"]["surprise_held_s"]
    with pytest.raises(ValueError, match=r"weights\.surprised weighs nothing; say perception\.surprise_held_s, too"):
        CriticSettings.model_validate_json(json.dumps(content))
