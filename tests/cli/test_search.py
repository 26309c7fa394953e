"""`kurt2rt study search` as a user meets it."""

import json
import sys
from pathlib import Path

import pytest
import yaml

from tests.cli.helpers import CommandLine
from tests.experiments.search.tiny import SHORT, tiny_search
from tests.experiments.study.page import Page

SET = [word for key, value in SHORT.items() for word in ("--set", f"{key}={value}")]
WORDS = ("--jobs", "1", "--out", "made", *SET)


def test_search_checks_once_and_says_where_it_came_from(kurt2rt: CommandLine, tmp_path: Path) -> None:
    said = kurt2rt("study", "search", tiny_search(tmp_path), *WORDS)
    assert said.exit_code == 0, said.err
    assert "Best trials of 3" in said.out
    assert said.out.endswith("found   made/found.yaml\nreport  made/report.html\n")

    found = yaml.safe_load(Path("made/found.yaml").read_text())
    assert found["command"].startswith("kurt2rt study search tiny.yaml --set teaching.supervised_s=1.5 ")
    assert found["search"] == {"seeds": "3000-3001", "worlds": ["a"]}
    assert found["check"] == {"seeds": "1000-1001", "worlds": ["b"]}
    assert (found["study"], found["task"], found["trials"]) == ("tiny", "wall_following", 3)
    assert len(found["checked"]) == 1
    assert found["shipped"]["values"]["learning.radius"] == 900.0
    assert len(found["source"]) == 16
    assert found["verdict"] in Path("made/report.html").read_text()
    page = Page(Path("made/report.html").read_text())
    assert page.images == ["Trials"]
    assert all(address.startswith("data:") for address in page.addresses)

    results = {path: path.stat().st_mtime_ns for path in Path("made").rglob("*.json")}
    again = kurt2rt("study", "search", tiny_search(tmp_path), *WORDS, "--json")
    assert {path: path.stat().st_mtime_ns for path in results} == results  # nothing is measured again
    told = json.loads(again.out)
    assert told["verdict"] == found["verdict"]
    assert (told["better"] is None) == (found["changes"] == {})
    assert yaml.safe_load(Path("made/found.yaml").read_text()) == found
    assert "allowed 3" in kurt2rt.refused("study", "search", tiny_search(tmp_path), *WORDS, "--trials", "4")


@pytest.mark.parametrize(
    ("other", "told"),
    [
        ({"task": "sledging"}, "sledging: no such name in tasks"),
        ({"teacher": "nosuch"}, "nosuch: no such name in teachers"),
        ({"task": "streets", "engine": "compiled"}, "learning.weights.0.weight"),
        ({"search": {"seeds": {"first": 1500, "count": 2}, "worlds": ["a"]}}, "1500 is for reports"),
        ({"search": {"seeds": {"first": 0, "count": 2}, "worlds": ["nowhere"]}}, "nowhere"),
    ],
)
def test_wrong_search_is_refused_before_anything_runs(
    kurt2rt: CommandLine, tmp_path: Path, other: dict[str, object], told: str
) -> None:
    assert told in kurt2rt.refused("study", "search", tiny_search(tmp_path, **other), *WORDS)
    assert not Path("made").exists()


def test_search_without_optuna_names_its_extra(
    kurt2rt: CommandLine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "optuna", None)
    for name in [name for name in sys.modules if name.startswith("kurt2rt.experiments.search")]:
        monkeypatch.delitem(sys.modules, name)
    line = kurt2rt.refused("study", "search", tiny_search(tmp_path), *WORDS)
    assert "pip install '.[studies]' in kurt2rt's folder" in line
