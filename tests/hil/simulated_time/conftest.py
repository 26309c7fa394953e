import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.hil.simulated_time.played import Played
from tests.hil.simulated_time.stage import Story, order

ROOT = Path(__file__).parents[3]


@pytest.fixture
def play(tmp_path: Path) -> Callable[[Story], Played]:
    """Return a function that runs a story in a machine of its own. Fails if no machine can be had."""

    def play(story: Story) -> Played:
        folder = tmp_path / f"story-{len(list(tmp_path.iterdir()))}"
        folder.mkdir()
        machine = [sys.executable, "-m", "tests.hil.machine", "--simulated-time", "--share", str(folder)]
        done = subprocess.run([*machine, *order(folder, story)], cwd=ROOT, capture_output=True, text=True, check=False)
        assert done.returncode == 0, f"{done.stdout}{done.stderr}"
        return Played(folder)

    return play
