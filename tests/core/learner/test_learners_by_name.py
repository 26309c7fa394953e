from pathlib import Path

import pytest

from kurt2rt.core.learner import learners
from kurt2rt.core.learner.learners import NoLearnerError, find_learner, learner_names, source_of_learner
from kurt2rt.core.learner.rla_learner import RlaLearner
from tests.plugin_packages import install

MINE = "from kurt2rt.core.learner.rla_learner import RlaLearner\n\n\nclass Mine(RlaLearner):\n    pass\n"


def test_find_learner_by_entry_point(plugin_folder: Path) -> None:
    install(plugin_folder, "theirs", {"learners": {"theirs": "kurt2rt.core.learner.rla_learner:RlaLearner"}})
    assert find_learner("theirs") is RlaLearner
    assert learner_names()[-1] == "theirs"


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("k-n", "there is no such learner; give module:Name, or one of: rla-door, 1-nn"),
        ("no_such_module:Mine", "there is no module 'no_such_module' on Python's path or in "),
        ("kurt2rt.core.learner.rla_learner:Rlalearner", "rla_learner.py has no 'Rlalearner'"),
        ("kurt2rt.core.learner.rla_learner:", "there is no such learner"),
        ("kurt2rt.core.learner.learner:Why", "is the class Why, allowed is a class with the methods decide, lesson, "),
    ],
)
def test_find_learner_refuses_what_is_none(name: str, text: str) -> None:
    with pytest.raises(NoLearnerError) as refused:
        find_learner(name)
    assert text in str(refused.value)
    assert str(refused.value).startswith(f"learner {name}: ")


def test_missing_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(learners._BUILTIN, "needy", "no_such_package_of_an_extra.learner:Needy")
    with pytest.raises(NoLearnerError, match="studies"):
        find_learner("needy")


def test_source_of_a_learner_outside_changes_with_its_file(plugin_folder: Path) -> None:
    (plugin_folder / "mine_first.py").write_text(MINE)
    (plugin_folder / "mine_second.py").write_text(MINE + "# more\n")
    first, second = source_of_learner("mine_first:Mine"), source_of_learner("mine_second:Mine")
    assert first != second
    assert first
    assert source_of_learner("1-nn") == ""
