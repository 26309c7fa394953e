"""`kurt2rt faults`, as it is typed."""

import json
from pathlib import Path

import pytest

from config import CONFIG_DIR
from hal.settings import content_of
from kurt2rt.checks.faults.complaint import ComplaintCode
from kurt2rt.checks.faults.table import KINDS, TARGETS
from tests.cli.helpers import CommandLine

STUCK = ("faults", "--target", "tick", "--kind", "stuck")


def changed_table(tmp_path: Path, **update: object) -> str:
    content = content_of(CONFIG_DIR / "faults" / "kurt2.yaml")
    content["cases"]["tick"]["stuck"].update(update)
    path = tmp_path / "mine.yaml"
    path.write_text(json.dumps(content))
    return str(path)


def test_some_cases_print_their_matrix_and_write_json(kurt2rt: CommandLine, tmp_path: Path) -> None:
    file = tmp_path / "faults.json"
    said = kurt2rt(*STUCK, "--kind", "wrong", "--seeds", "2", "--json", file)
    assert said.exit_code == 0, said.err
    assert "\n2 cases, 4 trials, 0 " in said.out
    assert "tick hung" in said.out
    for word in ("stands: ", "asks: ", "stutters: ", "drives: "):
        assert word in said.out
    report = json.loads(file.read_text(encoding="utf-8"))
    (hung,) = report["stop_times"]
    assert hung["trials"] == 2
    assert 0.1 <= hung["median_s"] <= hung["worst_s"] <= 0.11
    assert [(row["kind"], row["seed"], row["passed"]) for row in report["trials"]] == [
        ("stuck", 1, True),
        ("stuck", 2, True),
        ("wrong", 1, True),
        ("wrong", 2, True),
    ]
    assert report["trials"][0]["last"]["because"] == ["ticks ceased"]


def test_faults_deviation_exits_with_code_1(kurt2rt: CommandLine, tmp_path: Path) -> None:
    said = kurt2rt(
        *STUCK, "--table", changed_table(tmp_path, within_s=0.05), "--json", file := tmp_path / "faults.json"
    )
    assert said.exit_code == 1
    assert "seed 1: " in said.out
    assert "NOT SO" in said.out
    (trial,) = json.loads(file.read_text(encoding="utf-8"))["trials"]
    assert trial["codes"] == [ComplaintCode.STOOD_LATE]


def test_a_known_gap_is_said(kurt2rt: CommandLine, tmp_path: Path) -> None:
    said = kurt2rt(*STUCK, "--table", changed_table(tmp_path, because="bus lost", known_gap="cause unknown"))
    assert said.exit_code == 0
    assert "gap: cause unknown\n" in said.out
    assert "1 known gaps" in said.out


@pytest.mark.parametrize(
    ("option", "name", "known"), [("--target", "wings", TARGETS), ("--kind", "tired", KINDS)], ids=["target", "kind"]
)
def test_faults_unknown_target_lists_the_known_ones(
    kurt2rt: CommandLine, option: str, name: str, known: tuple[str, ...]
) -> None:
    line = kurt2rt.misused("faults", option, name)
    assert name in line
    assert ", ".join(known) in line


def test_a_robot_that_stands_anyway_shows_nothing(kurt2rt: CommandLine, tmp_path: Path) -> None:
    content = content_of(CONFIG_DIR / "faults" / "kurt2.yaml")
    path = tmp_path / "standing.yaml"
    path.write_text(json.dumps({**content, "action": "stand"}))
    said = kurt2rt(*STUCK, "--table", path)
    assert said.exit_code == 2
    assert said.err.splitlines()[-1].startswith("kurt2rt: tick stuck:")
