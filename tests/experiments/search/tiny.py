"""A search of seconds: too short to find anything, long enough to leave every kind of result."""

from pathlib import Path
from typing import Any

import yaml

from kurt2rt.experiments.search.plan import SearchPlan, make_plan
from kurt2rt.experiments.search.settings import SearchSettings, load_search
from tests.experiments.study.here import parts_in

CONTENT: dict[str, Any] = {
    "name": "tiny",
    "task": "wall_following",
    "teacher": "attentive",
    "engine": "can",
    "trials": 3,
    "at_once": 2,
    "search": {"seeds": {"first": 3000, "count": 2}, "worlds": ["a"]},
    "check": {"seeds": {"first": 1000, "count": 2}, "worlds": ["b"], "best": 1},
    "space": [
        {"key": "learning.radius", "low": 300.0, "high": 2000.0, "log": True},
        {"key": "learning.weights.0.weight", "low": 0.5, "high": 3.0},
    ],
}
SHORT = {"teaching.supervised_s": "1.5", "teaching.corrections_s": "0.5", "exam.duration_s": "1"}


def tiny_search(folder: Path, **other: Any) -> Path:
    """Write the file of a tiny search, with other values of some keys; return its path."""
    path = folder / "tiny.yaml"
    path.write_text(yaml.safe_dump({**CONTENT, **other}))
    return path


def tiny_settings(folder: Path, **other: Any) -> SearchSettings:
    return load_search(str(tiny_search(folder, **other)))


def tiny_plan(folder: Path, **other: Any) -> SearchPlan:
    return make_plan(tiny_settings(folder, **other), parts_in(folder / "made"), changes=SHORT)
