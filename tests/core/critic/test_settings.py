"""Settings of critics."""

import json
from pathlib import Path
from typing import Any

import pytest

from hal.settings import SettingsError
from kurt2rt.core.critic.settings import (
    CIRCLING,
    GRAZING,
    NAMES,
    SPUN,
    AppraisalWeights,
    CriticSettings,
    load_critic,
)

CONTENT: dict[str, Any] = load_critic().model_dump(mode="json")


def changed(section: str, **values: object) -> dict[str, Any]:
    return CONTENT | {section: CONTENT[section] | values}


def checked(content: dict[str, Any]) -> CriticSettings:
    return CriticSettings.model_validate_json(json.dumps(content))


def test_circling_feature_needs_its_settings() -> None:
    content = json.loads(load_critic("eight_with_memory").model_dump_json())
    assert checked(content).names == (*NAMES, CIRCLING, GRAZING)
    del content["perception"]["circling"]
    with pytest.raises(ValueError, match=r"weights\.circling .*perception\.circling"):
        checked(content)
    del content["learning"]["weights"]["circling"]
    assert checked(content).names == (*NAMES, GRAZING)
    assert checked(content).feature_hash != load_critic("eight_with_memory").feature_hash


def test_feature_hash_depends_on_features_only() -> None:
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
        (changed("learning", weights={"left_m": 0.0}), "weighs 0"),
        (changed("agreement", least=31), r"\bleast\b.* 31, .*window \(30\)"),
        (CONTENT | {"appraisals": CONTENT["appraisals"][:2]}, r"-1 .*\b1\b"),
        (CONTENT | {"appraisals": CONTENT["appraisals"] * 2}, "bad, good, neutral"),
    ],
)
def test_critic_settings_invalid_values_are_refused(content: dict[str, Any], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        checked(content)


def test_appraisal_weights_cover_each_feature(tmp_path: Path) -> None:
    assert set(AppraisalWeights.model_fields) == {*NAMES, CIRCLING, GRAZING, SPUN}
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text(json.dumps(changed("learning", weights={"lift_m": 1.0})))
    with pytest.raises(SettingsError, match=r"weights\.lift_m: .*: left_m, front_m, right_m"):
        load_critic(str(wrong))
