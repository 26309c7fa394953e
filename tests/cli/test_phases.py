"""`kurt2rt study phases` as a user meets it."""

import json
from pathlib import Path

import pytest

from tests.cli.helpers import CommandLine, results_in

QUICK = ("study", "phases", "--quick", "--seeds", "0", "--jobs", "1")


def alone(result: Path) -> tuple[str, bool, int]:
    """Step, whether the critic was trusted in it all the time, and how often it changed something."""
    (stage,) = json.loads(result.read_text())["stages"]
    return stage["name"], stage["teaching"]["share_trusted"] > 0.99, stage["teaching"]["critics_changes"]


@pytest.mark.parametrize("task", ["wall_following", "fleeing", "eight"])
@pytest.mark.deep
def test_phases_quick_runs_again_only_the_job_without_result(kurt2rt: CommandLine, task: str) -> None:
    first = kurt2rt(*QUICK, "--task", task)
    assert first.exit_code == 0, first.err
    assert "MISSED" not in first.out
    folder = Path(f"results/phases/{task}-quick")
    assert first.out.endswith(f" {folder}/report.html\n")
    results = sorted(folder.glob("results/*/*.json"))
    assert len(results) == 14
    _, trusted, changes = zip(*map(alone, folder.glob("results/critic-[as]*/*.json")), strict=True)
    assert all(trusted)
    # The critic of the eight judges circling by its memory, which takes longer than a quick run.
    assert sum(changes) > 0 or task == "eight"
    stamps_ns = [path.stat().st_mtime_ns for path in results]
    results[4].unlink()
    again = kurt2rt(*QUICK, "--task", task)
    assert again.out == first.out
    changed = [path.stat().st_mtime_ns != stamp_ns for path, stamp_ns in zip(results, stamps_ns, strict=True)]
    assert changed == [place == 4 for place in range(14)]
    assert f"kurt2rt study phases --task {task} --quick --seeds 0" in (folder / "report.html").read_text()


@pytest.mark.parametrize("task", ["school/fleeing", "turtlebot/wall_following"])
@pytest.mark.deep
def test_phases_quick_trains_another_robot(kurt2rt: CommandLine, task: str) -> None:
    told = kurt2rt(*QUICK, "--task", task)
    assert told.exit_code == 0, told.err
    folder = Path(f"results/phases/{task.replace('/', '_')}-quick")
    results = list(folder.glob("results/*/*.json"))
    assert len(results) == 14
    _, trusted, _ = zip(*map(alone, folder.glob("results/critic-[as]*/*.json")), strict=True)
    assert all(trusted)


@pytest.mark.deep
def test_phases_quick_in_the_batch_has_the_results_of_the_bus(kurt2rt: CommandLine) -> None:
    for engine in ("compiled", "can"):
        told = kurt2rt(*QUICK, "--out", engine, "--engine", engine)
        assert told.exit_code == 0, told.err
    assert results_in("compiled") == results_in("can")
    assert len(results_in("can")) == 14
    assert len(list(Path("compiled/results/witnesses").glob("*/*.json"))) == 3
