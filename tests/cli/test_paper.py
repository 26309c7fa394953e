"""`kurt2rt study paper` as a user meets it."""

from pathlib import Path
from typing import Any

import pytest
import yaml

from config import CONFIG_DIR
from tests.cli.helpers import CommandLine, results_in, unknown_name

PAPER = ("study", "paper", "--jobs", "1", "--no-paper-defaults")
COMMAND = "kurt2rt study paper --seeds 100 --task short.yaml --no-paper-defaults"


def short_task(folder: Path, **teaching: Any) -> Path:
    """Write the task circle with seconds of teaching and exam; return its path."""
    content = yaml.safe_load((CONFIG_DIR / "tasks" / "circle.yaml").read_text())
    content["name"] = "short_circle"
    content["teaching"] |= {"supervised_s": 2.0, "corrections_s": 1.0} | teaching
    content["exam"]["duration_s"] = 1.0
    path = folder / "short.yaml"
    path.write_text(yaml.safe_dump(content))
    return path


def test_a_task_of_ones_own_is_taught_examined_and_reported(kurt2rt: CommandLine, tmp_path: Path) -> None:
    words = (*PAPER, "--task", short_task(tmp_path), "--seeds", "100", "--out", "made")
    first = kurt2rt(*words)
    assert first.exit_code == 0, first.err
    assert "short circle" in first.out
    assert "Plain" not in first.out
    assert first.out.endswith(" made/report.html\n")
    made = sorted(str(path.relative_to("made")) for path in Path("made").rglob("*") if path.is_file())
    assert made == [
        *(".lock", "drive-short_circle.png", "fig4.png", "fig6.png", "knowledge/shipped/short_circle-100.knowledge"),
        *("passed.png", "report.html", "results/shipped/short_circle-100.json"),
    ]
    report = Path("made/report.html").read_text()
    assert COMMAND in report
    assert str(tmp_path) not in report

    short_task(tmp_path, supervised_s=3.0)
    line = kurt2rt.refused(*words)
    assert " made: results/shipped/short_circle-100.json " in line
    assert ": task)" in line  # what differs


def test_an_unknown_world_is_refused_before_anything_runs(kurt2rt: CommandLine, tmp_path: Path) -> None:
    said = kurt2rt.refused("study", "paper", "--task", short_task(tmp_path, world="nowhere"), "--out", "made")
    assert unknown_name("worlds", "nowhere") in said
    assert not Path("made").exists()


def test_a_folder_that_cannot_be_made_is_refused(kurt2rt: CommandLine, tmp_path: Path) -> None:
    Path("made").write_text("a file")
    said = kurt2rt.refused("study", "paper", "--task", short_task(tmp_path), "--out", "made")
    assert "made" in said


@pytest.mark.deep
def test_paper_quick_has_a_result_of_each_job(kurt2rt: CommandLine) -> None:
    said = kurt2rt("study", "paper", "--quick", "--jobs", "2")
    assert said.exit_code == 0, said.err
    assert "A part only" in said.out
    assert "MISSED" not in said.out
    assert len(list(Path("results/paper-quick/results").glob("[!w]*/*.json"))) == 28  # without witnesses


@pytest.mark.deep  # quick ones: a lesson of many robots in test_engine, and the witness of a job
def test_paper_in_the_batch_has_the_results_of_the_bus(kurt2rt: CommandLine, tmp_path: Path) -> None:
    words = (*PAPER, "--task", short_task(tmp_path), "--seeds", "100-101")
    told = {engine: kurt2rt(*words, "--out", engine, "--engine", engine) for engine in ("compiled", "can")}
    assert [each.exit_code for each in told.values()] == [0, 0]
    assert "2 jobs in the batch, 2 of them on the CAN bus too" in told["compiled"].err
    assert results_in("compiled") == results_in("can")
    assert len(list(Path("compiled/results/witnesses/shipped").glob("short_circle-*.json"))) == 2


@pytest.mark.deep
def test_paper_goes_on_in_the_batch_where_it_was_on_the_bus(kurt2rt: CommandLine, tmp_path: Path) -> None:
    words = (*PAPER, "--task", short_task(tmp_path), "--out", "made")
    kurt2rt(*words, "--seeds", "100", "--engine", "can")
    (path,) = Path("made/results/shipped").glob("*.json")
    stamp_ns = path.stat().st_mtime_ns
    told = kurt2rt(*words, "--seeds", "100-101", "--engine", "compiled")
    assert told.exit_code == 0, told.err
    assert path.stat().st_mtime_ns == stamp_ns
    # The robot of the bus has a witness all the same, so that the study has its share of them.
    assert len(list(Path("made/results/witnesses").rglob("*.json"))) == 2
