"""Files of searches: shipped ones load, and wrong ones are refused in one line."""

from pathlib import Path
from typing import Any

import pytest

from config.settings import SettingsError
from config.settings_files import shipped_names
from kurt2rt.core.teacher_settings import load_teacher
from kurt2rt.experiments.search.settings import TaskSpace, load_search, may_be_searched
from tests.experiments.search.tiny import CONTENT, tiny_settings


@pytest.mark.parametrize("name", shipped_names("searches"))
def test_shipped_search_fits_its_task(name: str) -> None:
    search = load_search(name)
    space = TaskSpace(search, {}, load_teacher(search.teacher))
    assert space.task({**space.shipped, search.space[0].key: search.space[0].low}) != space.task(space.shipped)
    assert search.name == name


@pytest.mark.parametrize("seed", [0, 999, 3000, 3999])
def test_search_seeds_are_below_1000_and_3000_to_3999(seed: int) -> None:
    assert may_be_searched(seed)
    assert not may_be_searched({0: 4000, 999: 1000, 3000: 2999, 3999: 4000}[seed])


def _seeds(part: str, first: int, count: int = 2) -> dict[str, Any]:
    return {part: {**CONTENT[part], "seeds": {"first": first, "count": count}}}


def _dimension(**values: Any) -> dict[str, Any]:
    return {"space": [{"key": "learning.radius", "low": 300.0, "high": 2000.0, **values}]}


@pytest.mark.parametrize(
    ("other", "told"),
    [
        (_seeds("search", 999), r"1000 is for reports \(got 1000, allowed 0-999 and 3000-3999\)"),
        (_seeds("search", 100, 901), "1000 is for reports"),
        (_seeds("check", 3000), "3000 is for searches"),
        (_seeds("check", 2999), "3000 is for searches"),
        ({"check": {**CONTENT["check"], "worlds": ["rooms-7"]}, "search": {**CONTENT["search"], "worlds": ["rooms-7"]}},
         "rooms-7 is a world of the search"),
        (_dimension(low=2000.0), "low must be less than high"),
        (_dimension(low=0.0, log=True), "low must be positive"),
        (_dimension(key="radius"), "space.0.key"),
        ({"space": _dimension()["space"] * 2}, "learning.radius stands twice"),
        ({"space": []}, "space"),
        ({"objective": "quick"}, "objective"),
        ({"trials": 0}, "trials"),
    ],
)  # fmt: skip
def test_wrong_search_is_refused_in_one_line(other: dict[str, Any], told: str, tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match=told) as caught:
        tiny_settings(tmp_path, **other)
    assert "tiny.yaml" in str(caught.value)
    assert "\n" not in str(caught.value)
