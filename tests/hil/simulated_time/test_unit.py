"""The unit that `kurt2rt service install` makes, started by a real systemd in a machine of its own."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
STORY = "tests/hil/simulated_time/unit_story.py"

pytestmark = pytest.mark.boots


@pytest.mark.timeout(3600)
def test_the_unit_under_systemd() -> None:
    machine = [sys.executable, "-m", "tests.hil.machine", "--simulated-time", "--systemd", "--limit", "3000"]
    pytest_there = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", STORY]
    done = subprocess.run([*machine, *pytest_there], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{done.stdout}{done.stderr}"
    assert " passed in " in done.stdout
