"""Robot, runtime, teacher and can-utils as programs that know nothing of a test, in a machine in simulated time.

However much this machine has to do at the same time, none of them is late there.
"""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]

pytestmark = pytest.mark.boots


@pytest.mark.timeout(1800)
@pytest.mark.parametrize("stories", ["tests/hil/test_story.py", "tests/hil/simulated_time/programs_story.py"])
def test_stories_of_several_programs(stories: str) -> None:
    machine = [sys.executable, "-m", "tests.hil.machine", "--simulated-time"]
    pytest_there = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-m", "hil or not hil", stories]
    done = subprocess.run([*machine, *pytest_there], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{done.stdout}{done.stderr}"
    assert " passed in " in done.stdout
