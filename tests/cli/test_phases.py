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


@pytest.mark.parametrize("task", ["wall_following", "fleeing", "eight", "school/fleeing", "turtlebot/wall_following"])
@pytest.mark.deep
def test_phases_quick_trains_robots_whose_critic_is_trusted(kurt2rt: CommandLine, task: str) -> None:
    # An ordinary teacher appraises too little in a quick run for a critic of the school robot to be trusted.
    said = kurt2rt(*QUICK, "--task", task, "--teacher", "superhuman")
    assert said.exit_code == 0, said.err
    assert "MISSED" not in said.out
    folder = Path(f"results/phases/{task.replace('/', '_')}-quick")
    assert said.out.endswith(f" {folder}/report.html\n")
    assert len(list(folder.glob("results/*/*.json"))) == 14
    _, trusted, changes = zip(*map(alone, folder.glob("results/critic-[as]*/*.json")), strict=True)
    assert all(trusted)
    # The critic of the eight judges circling by its memory, which takes longer than a quick run.
    assert sum(changes) > 0 or task not in ("wall_following", "fleeing")
    command = f"kurt2rt study phases --task {task} --teacher superhuman --quick --seeds 0"
    assert command in (folder / "report.html").read_text()


@pytest.mark.deep
def test_phases_quick_in_the_batch_has_the_results_of_the_bus(kurt2rt: CommandLine) -> None:
    for engine in ("compiled", "can"):
        told = kurt2rt(*QUICK, "--out", engine, "--engine", engine)
        assert told.exit_code == 0, told.err
    assert results_in("compiled") == results_in("can")
    assert len(results_in("can")) == 14
    assert len(list(Path("compiled/results/witnesses").glob("*/*.json"))) == 3
