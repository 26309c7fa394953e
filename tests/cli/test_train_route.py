"""`kurt2rt train --task route` as a user meets it."""

from pathlib import Path

import pytest

from kurt2rt.core.task_settings import load_task
from tests.cli.helpers import CommandLine
from tests.experiments.helpers import teach
from tests.experiments.route.test_study import short

SHORT = ("--set", "teaching.corrections_s=1.5", "--set", "exam.duration_s=1", "--set", "metric.starts=1")


@pytest.fixture(scope="module")
def streets(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Teach two robots the streets for some seconds; return the folder of their knowledge."""
    folder = tmp_path_factory.mktemp("streets")
    for seed in (1, 2):
        teach(folder / f"streets-{seed}.knowledge", short(load_task("streets"), 2.0), seed)
    return folder


def test_one_robot_is_taught_a_route_drives_it_and_is_drawn(kurt2rt: CommandLine, streets: Path) -> None:
    said = kurt2rt("train", "--task", "route", "--basic", streets, "--decisions", "12", "--out", "made", *SHORT)
    assert said.exit_code == 0, said.err
    assert "of 12 decisions" in said.out
    assert "mid-level RLAs" in said.out
    assert Path("made/route-12-1.png").is_file()
    # What was taught can be gone on with, and examined again, on the same route.
    knowledge = "made/route-12-1.knowledge"
    assert kurt2rt("train", "--task", "route", "--knowledge", knowledge, "--out", "made", *SHORT).exit_code == 0
    said = kurt2rt("exam", knowledge, "--task", "route", "--set", "metric.decisions=12", *SHORT)
    assert said.exit_code == 0, said.err


def test_many_robots_leave_a_report_and_are_not_taught_again(kurt2rt: CommandLine, streets: Path) -> None:
    words = ("train", "--task", "route", "--seeds", "1,2", "--basic", streets, "--jobs", "1", "--out", "made", *SHORT)
    said = kurt2rt(*words)
    assert said.exit_code == 0, said.err
    assert " 2 robots " in said.out
    report = Path("made/report.html").read_text(encoding="utf-8")
    assert "kurt2rt train --task route --set " in report
    assert " --seeds 1,2 --basic streets" in report
    assert str(streets) not in report
    kept = Path("made/results/route-8-1.json")
    before = kept.stat().st_mtime_ns
    assert kurt2rt(*words).exit_code == 0
    assert kept.stat().st_mtime_ns == before


def test_streets_that_nobody_taught_are_asked_for(kurt2rt: CommandLine, streets: Path) -> None:
    said = kurt2rt.refused("train", "--task", "route", "--seed", "3", "--basic", streets)
    assert f"{streets / 'streets-3.knowledge'}: " in said
    assert "kurt2rt train --task streets" in said
    assert not Path("results").exists()
