"""Checks of Python and of the optional packages."""

import subprocess
import sys
from collections.abc import Mapping
from functools import cache
from importlib.metadata import packages_distributions, version

from kurt2rt.checks.doctor.check_result import CheckResult, CheckStatus, FindingCode

LEAST_PYTHON = (3, 11)


def check_python(found: tuple[int, int, int] = sys.version_info[:3]) -> CheckResult:
    """Check that Python is new enough."""
    name = ".".join(map(str, found))
    if found[:2] < LEAST_PYTHON:
        least = ".".join(map(str, LEAST_PYTHON))
        return CheckResult(FindingCode.PYTHON_OLD, CheckStatus.MISSING, {"version": name, "least": least}, needed=True)
    return CheckResult(FindingCode.PYTHON, CheckStatus.OK, {"version": name}, needed=True)


def check_package(name: str, used_for: str, extra: str = "simulation", python: str = sys.executable) -> CheckResult:
    """Check that a package of an extra can be imported by the interpreter `python`.

    `used_for` and `extra`: for the advice. The import runs in another process, because a broken native library may
    crash the interpreter.
    """
    fault = _import_fault(name, python)
    if fault:
        values = {"name": name, "used_for": used_for, "fault": fault, "python": python, "extra": extra}
        return CheckResult(FindingCode.PACKAGE_MISSING, CheckStatus.MISSING, values)
    found = version(_distributions()[name][0])
    return CheckResult(FindingCode.PACKAGE, CheckStatus.OK, {"name": name, "used_for": used_for, "version": found})


@cache
def _distributions() -> Mapping[str, list[str]]:
    """Return the distributions of each package; to read the files of all of them takes 0.2 s."""
    return packages_distributions()


def _import_fault(name: str, python: str) -> str:
    """Return the last line of the import's error; empty without one."""
    try:
        trial = subprocess.run([python, "-c", f"import {name}"], capture_output=True, text=True, check=False)
    except OSError as error:
        return f"Python could not be started: {error}"
    if trial.returncode == 0:
        return ""
    said = trial.stderr.strip().splitlines()
    return said[-1] if said else f"the import ended with code {trial.returncode}"
