"""Results of the shipped searches, in config/searches/found: the tasks have the settings that they say."""

from pathlib import Path
from typing import Any

import pytest
import yaml

from config.settings_files import find_config, shipped_names
from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.search.settings import content_of_task, load_search, value_at

FOUND = sorted((find_config("searches", "wall_following").parent / "found").glob("*.yaml"))


def found_in(path: Path) -> dict[str, Any]:
    content: dict[str, Any] = yaml.safe_load(path.read_text())
    return content


def test_each_result_is_of_a_shipped_search() -> None:
    assert FOUND
    assert {path.stem for path in FOUND} <= set(shipped_names("searches"))


@pytest.mark.parametrize("path", FOUND, ids=lambda path: path.stem)
def test_task_has_the_settings_that_its_search_left(path: Path) -> None:
    found = found_in(path)
    search = load_search(path.stem)
    assert (found["study"], found["task"], found["teacher"]) == (search.name, search.task, search.teacher)
    assert set(found["shipped"]["values"]) == {each.key for each in search.space}
    content = content_of_task(load_task(search.task))
    # Where no trial was better, `changes` is empty. A later comparison may have changed a task by hand.
    left = {**found["shipped"]["values"], **found["changes"], **found.get("changed_since", {})}
    for key, value in left.items():
        assert value_at(content, key) == value, key
