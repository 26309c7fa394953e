"""The first `make run` says that it installs, and how long that takes; it starts the page for phones as well."""

import hashlib
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from config.settings_files import shipped_names

ROOT = Path(__file__).parents[1]


def dry(folder: Path, *targets: str) -> str:
    """Return the commands of `make` for these targets in a fresh clone."""
    for name in ("Makefile", "pyproject.toml", "constraints.txt"):
        shutil.copy(ROOT / name, folder / name)
    shutil.copytree(ROOT / "config" / "searches", folder / "config" / "searches")
    # The make that runs the tests hands down its own options, such as printing each directory.
    environment = {name: value for name, value in os.environ.items() if not name.startswith("MAKE")}
    words = ["make", "--dry-run", *targets]
    done = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, check=True)
    return done.stdout


@pytest.fixture
def dry_run(tmp_path: Path) -> str:
    return dry(tmp_path, "run", "ARGS=--auto")


def test_make_studies_makes_each_shipped_search_again(tmp_path: Path) -> None:
    line = dry(tmp_path, "studies").splitlines()[-1]
    assert set(shipped_names("searches")) <= set(line.split(";")[0].split())
    assert "kurt2rt study search $name" in line


def test_make_wheelhouse_takes_wheels_alone_for_both_processors(tmp_path: Path) -> None:
    said = dry(tmp_path, "wheelhouse")
    assert "for machine in x86_64 aarch64;" in said
    assert "--only-binary :all:" in said
    assert "--abi cp311 --abi abi3 --abi none" in said
    assert "'.[page,recording]'" in said


def test_wheelhouse_requirements_hold_a_hash_of_each_wheel(tmp_path: Path) -> None:
    command = re.search(r"sha256sum .*?> requirements\.txt", dry(tmp_path, "wheelhouse"), re.DOTALL)
    assert command is not None
    names = ("python_can-4.6.1-py3-none-any.whl", "cffi-2.1.1-cp311-cp311-manylinux2014_x86_64.manylinux_2_17.whl")
    for name in names:
        (tmp_path / name).write_bytes(name.encode())
    subprocess.run(["sh", "-c", command[0]], cwd=tmp_path, check=True)
    cffi, can = (hashlib.sha256(name.encode()).hexdigest() for name in sorted(names))
    lines = (tmp_path / "requirements.txt").read_text().splitlines()
    assert lines == [f"cffi==2.1.1 --hash=sha256:{cffi}", f"python_can==4.6.1 --hash=sha256:{can}"]


def test_first_make_run_says_that_it_installs_before_it_does(dry_run: str) -> None:
    said, installs = dry_run.index("a minute or two"), dry_run.index("-m venv")
    assert said < installs


def test_make_run_installs_no_packages_of_the_tests(dry_run: str) -> None:
    assert "'.[page,recording,simulation]'" in dry_run
    assert "'.[test]'" not in dry_run


def test_make_run_serves_phones_too(dry_run: str) -> None:
    assert dry_run.splitlines()[-1].endswith("kurt2rt run --phone --auto")
