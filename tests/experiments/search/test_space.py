"""Values of a trial in the task: single keys, and keys that lead through lists."""

from pathlib import Path
from typing import Any

import pytest

from config.settings import SettingsError
from kurt2rt.core.task_settings import load_task
from kurt2rt.core.teacher_settings import load_teacher
from kurt2rt.experiments.search.settings import Dimension, TaskSpace, rounded
from tests.experiments.search.tiny import tiny_settings


def space(folder: Path, *dimensions: dict[str, Any], teacher: str = "attentive", **changes: str) -> TaskSpace:
    search = tiny_settings(folder, **({"space": list(dimensions)} if dimensions else {}))
    dotted = {key.replace("__", "."): value for key, value in changes.items()}
    return TaskSpace(search, dotted, load_teacher(teacher))


def test_values_change_their_keys_alone(tmp_path: Path) -> None:
    of_task = space(tmp_path)
    shipped = load_task("wall_following").learning
    assert of_task.shipped == {"learning.radius": shipped.radius, "learning.weights.0.weight": 1.5}
    assert of_task.task(of_task.shipped).learning == shipped

    changed = of_task.task({"learning.radius": 444.0, "learning.weights.0.weight": 0.7}).learning
    assert (changed.radius, changed.weights[0].weight) == (444.0, 0.7)
    assert changed.weights[0].features == shipped.weights[0].features
    assert changed.weights[1:] == shipped.weights[1:]
    assert changed.model_copy(update={"radius": shipped.radius, "weights": shipped.weights}) == shipped


@pytest.mark.parametrize(
    ("key", "low", "high", "told"),
    [
        ("learning.radios", 1.0, 2.0, r"learning.radios: no such key \(got radios, allowed radius, history_weight,"),
        ("learning.weights.9.weight", 1.0, 2.0, r"no such key \(got 9, allowed 0, 1, 2, 3\)"),
        ("learning.weights.x.weight", 1.0, 2.0, r"no such key \(got x"),
        ("learning.radius.more", 1.0, 2.0, "no such key .* allowed nothing"),
        ("learning.answers_override_holds", 0.0, 1.0, "no number"),
        ("learning.weights.0.features", 0.0, 1.0, "no number"),
        ("learning.radius", 100.0, 800.0, r"leaves the shipped value out \(got 900, allowed 100 to 800\)"),
        ("learning.history_weight", 0.0, 20.0, "history_weight"),
    ],
)
def test_key_that_does_not_fit_is_refused(key: str, low: float, high: float, told: str, tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match=told):
        space(tmp_path, {"key": key, "low": low, "high": high})


def test_ranges_whose_ends_do_not_fit_each_other_are_refused(tmp_path: Path) -> None:
    usual = {"key": "learning.doubt.usual_distance", "low": 0.05, "high": 0.2}
    space(tmp_path, usual, {"key": "learning.doubt.rare_distance", "low": 0.21, "high": 0.9})
    with pytest.raises(SettingsError, match="rare_distance must be above usual_distance"):
        space(tmp_path, usual, {"key": "learning.doubt.rare_distance", "low": 0.11, "high": 0.9})


def test_key_that_the_teacher_decides_is_refused(tmp_path: Path) -> None:
    asks = {"key": "learning.ask_radius_fraction", "low": 0.3, "high": 1.0}
    space(tmp_path, asks)
    with pytest.raises(SettingsError, match="the teacher superhuman decides it"):
        space(tmp_path, asks, teacher="superhuman")


def test_key_that_a_change_decides_is_refused(tmp_path: Path) -> None:
    assert space(tmp_path, exam__duration_s="1").task({"learning.radius": 500.0}).exam.duration_s == 1.0
    with pytest.raises(SettingsError, match=r"--set learning\.radius decides it"):
        space(tmp_path, learning__radius="500")
    with pytest.raises(SettingsError, match=r"--set learning\.weights decides it"):
        space(tmp_path, learning__weights="[{weight: 1.0, features: [s15]}]")


def test_rounded_values_are_legible_and_in_range() -> None:
    share = Dimension(key="a.b", low=0.02, high=0.12345)
    assert [rounded(share, value) for value in (0.0312649, 0.1234499, 0.02)] == [0.0313, 0.123, 0.02]
    assert rounded(Dimension(key="a.b", low=1234.5, high=2000.0), 1234.6) == 1234.5
