"""Settings of critics."""

import json
from typing import Any

import pytest

from kurt2rt.core.critic.settings import (
    CIRCLING,
    GRAZING,
    NAMES,
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
