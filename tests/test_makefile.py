"""The first `make run` says that it installs, and how long that takes; it starts the page for phones as well."""

import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture
def dry_run(tmp_path: Path) -> str:
    """What `make run` would do in a fresh clone."""
    for name in ("Makefile", "pyproject.toml", "constraints.txt"):
        shutil.copy(ROOT / name, tmp_path / name)
    done = subprocess.run(
        ["make", "--dry-run", "run", "ARGS=--auto"], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    return done.stdout


def test_first_make_run_says_that_it_installs_before_it_does(dry_run: str) -> None:
    said, installs = dry_run.index("one to five minutes"), dry_run.index("-m venv")
    assert said < installs


def test_make_run_serves_phones_too(dry_run: str) -> None:
    assert dry_run.splitlines()[-1].endswith("kurt2rt run --phone --auto")
