import importlib.metadata
from pathlib import Path

import pytest

from kurt2rt.core.learner.rla_learner import RlaLearner
from kurt2rt.experiments.rivals import registry
from kurt2rt.experiments.rivals.registry import NoLearnerError, find_learner, learner_names, source_of_learner

MINE = "class Mine:\n    def __init__(self, setting):\n        self.setting = setting\n"


@pytest.fixture
def own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_find_learner_by_name_and_by_module() -> None:
    assert find_learner("rla-door") is RlaLearner
    assert find_learner("kurt2rt.core.learner.rla_learner:RlaLearner") is RlaLearner


def test_find_learner_in_the_current_folder(own_folder: Path) -> None:
    (own_folder / "mine_here.py").write_text(MINE)
    assert getattr(find_learner("mine_here:Mine"), "__name__", "") == "Mine"
    assert str(own_folder) not in __import__("sys").path


def test_find_learner_by_entry_point(monkeypatch: pytest.MonkeyPatch) -> None:
    point = importlib.metadata.EntryPoint(
        "theirs", "kurt2rt.core.learner.rla_learner:RlaLearner", registry.ENTRY_POINTS
    )
    monkeypatch.setattr(registry, "entry_points", lambda group: [point] if group == point.group else [])
    assert find_learner("theirs") is RlaLearner
    assert learner_names()[-1] == "theirs"


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("k-n", "there is no such learner; give module:Name, or one of rla-door, 1-nn, k-nn"),
        (
            "no_such_module:Mine",
            "cannot be imported: No module named 'no_such_module'; give a module that Python finds",
        ),
        ("kurt2rt.core.learner.rla_learner:Rlalearner", "has no class 'Rlalearner'"),
        ("kurt2rt.core.learner.rla_learner:", "there is no such learner"),
    ],
)
def test_find_learner_refuses_what_is_none(name: str, text: str) -> None:
    with pytest.raises(NoLearnerError) as refused:
        find_learner(name)
    assert text in str(refused.value)
    assert str(refused.value).startswith(f"learner {name}: ")


def test_missing_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(registry._BUILTIN, "needy", "no_such_package_of_an_extra.learner:Needy")
    with pytest.raises(NoLearnerError, match="rivals"):
        find_learner("needy")


def test_source_of_a_learner_outside_changes_with_its_file(own_folder: Path) -> None:
    (own_folder / "mine_first.py").write_text(MINE)
    (own_folder / "mine_second.py").write_text(MINE + "# more\n")
    first, second = source_of_learner("mine_first:Mine"), source_of_learner("mine_second:Mine")
    assert first != second
    assert first
    assert source_of_learner("1-nn") == ""
