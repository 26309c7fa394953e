"""Installation without extras: a robot drives, and other commands name the extra that they need."""

import json
import os
import re
import subprocess
import sys
import tomllib
from functools import cache
from importlib.metadata import PackageNotFoundError, packages_distributions, requires
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from kurt2rt.platform.extras import EXTRAS
from tests.cli.helpers import ROOT, CommandLine, Said
from tests.test_imports import PACKAGES

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
FOR_USERS = PROJECT["optional-dependencies"].keys() - {"test"}
REFUSED = {
    "recording": ("replay", "why", "recording repair", "run --record runs", "run --live-view 0"),
    "simulation": ("run", "sim --bus shared:base", "demo", "exam base.knowledge", "knowledge graph base.knowledge"),
    "page": ("teach --phone",),
    "studies": ("study worker --cluster x",),
    "export": ("recording export",),
    "ros": ("ros --device base",),
}
"""Commands that need an extra, by the extra."""
NEEDED_BY_NO_COMMAND = {"gymnasium", "llvmlite", "numba", "pytest"}


@cache
def installed() -> dict[str, list[str]]:
    """Return the distributions that bring each importable name."""
    return dict(packages_distributions())


@cache
def modules_of(extra: str = "") -> frozenset[str]:
    """Return the importable names that an extra brings, or for "" those that every installation has."""
    wanted = PROJECT["optional-dependencies"][extra] if extra else PROJECT["dependencies"]
    names = distributions(*map(Requirement, wanted))
    return frozenset(
        module for module, there in installed().items() if not names.isdisjoint(map(canonicalize_name, there))
    )


def distributions(*wanted: Requirement) -> set[str]:
    """Return the names of all installed distributions that these bring."""
    found, waiting = set[tuple[str, str]](), [(each.name, extra) for each in wanted for extra in ("", *each.extras)]
    while waiting:
        name, extra = waiting.pop()
        try:
            needed = map(Requirement, requires(name) or ())
        except PackageNotFoundError:  # for another system
            continue
        if (name, extra) in found:
            continue
        found.add((name, extra))
        for each in needed:
            if each.marker is None or each.marker.evaluate({"extra": extra}):
                waiting += [(each.name, more) for more in ("", *each.extras)]
    return {canonicalize_name(name) for name, _ in found}


@pytest.fixture(scope="module")
def said(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Said]:
    """Return what commands say without any extra, run one after the other in one process."""
    drive = f"run --bus shared:base-{os.getpid()} --teacher none --seconds 0.2 --knowledge base.knowledge"
    lines = ["knowledge --help", drive, *(each for lines in REFUSED.values() for each in lines)]
    hidden = set[str]().union(*map(modules_of, FOR_USERS)) - modules_of() - set(PACKAGES)
    given = {"hidden": sorted(hidden), "commands": [line.split() for line in lines]}
    done = subprocess.run(
        [sys.executable, "-m", "tests.cli.without_packages", json.dumps(given)],
        cwd=tmp_path_factory.mktemp("base"),
        env={**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "200"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    results = [Said(**each) for each in json.loads(done.stdout)]
    return dict(zip(("help", "drive", *lines[2:]), results, strict=True))


def test_robot_without_extras_drives_and_says_it_is_not_recorded(said: dict[str, Said]) -> None:
    assert said["help"].exit_code == 0
    assert said["drive"].exit_code == 0, said["drive"].err
    assert "the run is not recorded" in said["drive"].out
    assert "pip install '.[recording]' in kurt2rt's folder" in said["drive"].out


@pytest.mark.parametrize("extra", REFUSED)
def test_command_without_its_extra_names_the_extra(extra: str, said: dict[str, Said]) -> None:
    for line in REFUSED[extra]:
        assert said[line].exit_code == 2, line
        assert said[line].err.endswith(f"this command needs it: pip install '.[{extra}]' in kurt2rt's folder\n"), said[
            line
        ]


def test_study_without_scipy_is_refused_before_its_jobs(kurt2rt: CommandLine, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "scipy", None)
    monkeypatch.delitem(sys.modules, "scipy.special", raising=False)
    line = kurt2rt.refused("train", "--seeds", "0-1", "--out", "lessons")
    assert line.endswith("pip install '.[studies]' in kurt2rt's folder")
    assert not Path("lessons").exists()


def test_extras_of_main_bring_each_package_that_is_imported() -> None:
    texts = (path.read_text(encoding="utf-8") for package in PACKAGES for path in (ROOT / package).rglob("*.py"))
    imported = {
        name for text in texts for name in re.findall(r"^ *(?:import|from) (\w+)[\w.]*(?: import |$)", text, re.M)
    }
    foreign = imported - sys.stdlib_module_names - set(PACKAGES) - modules_of() - {"_typeshed"}
    assert foreign - NEEDED_BY_NO_COMMAND <= EXTRAS.keys()
    for module, extra in EXTRAS.items():
        assert module in modules_of(extra), module


def test_extra_for_tests_holds_all_that_users_may_install() -> None:
    assert set[str]().union(*map(modules_of, FOR_USERS)) <= modules_of("test")
