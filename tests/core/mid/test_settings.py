"""Settings of mid levels."""

import json
from typing import Any

import pytest

from kurt2rt.core.mid.settings import MidSettings, load_mid_level

CONTENT: dict[str, Any] = load_mid_level("turns").model_dump(mode="json", serialize_as_any=True)


def checked(**sections: dict[str, object]) -> MidSettings:
    content = {name: CONTENT[name] | sections.get(name, {}) if name != "name" else "turns" for name in CONTENT}
    return MidSettings.model_validate_json(json.dumps(content))


def test_builtin_mid_level_matches_the_paper() -> None:
    mid = load_mid_level("turns")
    assert (mid.space.dimensions, mid.space.radius, mid.space.metric) == (12, 6.0, "hamming")
    assert mid.situation.kind == "history"
    assert mid.features[0] == "symbol 1"
    assert load_mid_level(mid) is mid


def test_feature_hash_depends_on_features_only() -> None:
    bound = load_mid_level("turns").level_features
    assert bound.feature_names == load_mid_level("turns").features
    assert checked(learning={"radius": 3.0}).level_features == bound
    others = (checked(junctions={"wall_m": 0.41}), checked(situation={"length": 8}))
    assert len({each.level_features.feature_hash for each in (load_mid_level("turns"), *others)}) == 3


@pytest.mark.parametrize(
    ("section", "changes", "told"),
    [
        ("situation", {"kind": "weather"}, "'weather'; .*: history"),
        ("learning", {"radius": -1.0}, "radius"),
        ("junctions", {"left": ["s1"]}, "at least 2"),
    ],
)
def test_mid_settings_invalid_values_are_refused(section: str, changes: dict[str, object], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        checked(**{section: changes})
