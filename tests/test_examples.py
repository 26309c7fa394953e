"""The examples of the documentation teach a robot."""

import subprocess
import sys
from pathlib import Path

from kurt2rt.knowledge.journal import Journal
from kurt2rt.rla.rla import RlaCreated
from tests.cli.helpers import running

EXAMPLE = Path(__file__).parents[1] / "docs" / "examples" / "teach_from_a_notebook.py"


def test_a_notebook_teaches_the_robot(tmp_path: Path) -> None:
    with running("run", "--seconds", "60", "--port", "0", "--knowledge", "mine.knowledge", folder=tmp_path) as robot:
        port = robot.wait_for("teachers are listened to on UDP port").split()[-1]
        done = subprocess.run(
            [sys.executable, EXAMPLE, "var/devices/local", "--lessons", "2", "--port", port],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )
        assert (done.returncode, done.stderr) == (0, ""), done.stdout
        assert "local teaches" in done.stdout
        assert "answered" in done.stdout.splitlines()[-1]
    with Journal.read_only(tmp_path / "mine.knowledge") as journal:
        assert sum(isinstance(event, RlaCreated) for event in journal.events()) == 2
