"""Foreign packages that hide those of the program, noticed before the first import of one of them."""

import subprocess
import sys
from pathlib import Path

import pytest

from kurt2rt.platform.own_packages import hidden_packages
from tests.cli.helpers import ROOT


def test_hidden_packages_finds_none_in_this_program() -> None:
    assert hidden_packages() == ""


@pytest.mark.parametrize("words", [["-m", "kurt2rt.cli.main", "--help"], ["-c", "import kurt2rt; kurt2rt.Teacher"]])
def test_program_with_foreign_packages_says_their_folders(words: list[str], tmp_path: Path) -> None:
    (tmp_path / "config").mkdir()
    (tmp_path / "config" / "__init__.py").touch()
    (tmp_path / "hal.py").touch()
    (tmp_path / "behaviors").mkdir()  # no package: it hides nothing
    environment = {"PYTHONPATH": f"{tmp_path}:{ROOT}"}
    done = subprocess.run(
        [sys.executable, *words], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
    )
    (*_, line) = done.stderr.splitlines()
    assert done.returncode == (2 if "-m" in words else 1)
    assert line.endswith(
        f"Python finds foreign packages instead of those of kurt2rt, which are in {ROOT}: config in "
        f"{tmp_path}/config, hal in {tmp_path}/hal.py; rename or uninstall them, or take their folder off Python's "
        "path (PYTHONPATH, the folder of the script)"
    )
    if "-m" in words:
        assert done.stderr == f"kurt2rt: {line.removeprefix('kurt2rt: ')}\n"
