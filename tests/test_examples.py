"""The examples of the documentation teach a robot."""

import shutil
from pathlib import Path

from kurt2rt.knowledge.journal import Journal
from kurt2rt.rla.rla import RlaCreated
from tests.cli.helpers import running, started

EXAMPLE = Path(__file__).parents[1] / "docs" / "examples" / "teach_from_a_notebook.py"


def test_a_notebook_teaches_the_robot(tmp_path: Path) -> None:
    shutil.copy(EXAMPLE, tmp_path)
    with running("run", "--seconds", "120", "--port", "0", "--knowledge", "mine.knowledge", folder=tmp_path) as robot:
        port = robot.wait_for("teachers are listened to on UDP port").split()[-1]
        words = ("var/devices/local", "--lessons", "2", "--port", port)
        with started(EXAMPLE.stem, *words, folder=tmp_path) as notebook:
            out, err = notebook.communicate()
        assert (notebook.returncode, err) == (0, ""), out
        assert "local teaches" in out
        assert "answered" in out.splitlines()[-1]
    with Journal.read_only(tmp_path / "mine.knowledge") as journal:
        assert sum(isinstance(event, RlaCreated) for event in journal.events()) == 2
