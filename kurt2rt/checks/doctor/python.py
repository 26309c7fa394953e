"""Python itself and the packages that only some commands need."""

import subprocess
import sys
from importlib.metadata import version

from kurt2rt.checks.doctor.check_result import Finding, FindingCode, Status

LEAST_PYTHON = (3, 11)


def check_python(found: tuple[int, int, int] = sys.version_info[:3]) -> Finding:
    """Is Python new enough?"""
    name = ".".join(map(str, found))
    if found[:2] < LEAST_PYTHON:
        least = ".".join(map(str, LEAST_PYTHON))
        return Finding(FindingCode.PYTHON_OLD, Status.MISSING, {"version": name, "least": least}, needed=True)
    return Finding(FindingCode.PYTHON, Status.OK, {"version": name}, needed=True)


def check_package(name: str, used_for: str, python: str = sys.executable) -> Finding:
    """Can a package of the `simulation` extra be imported?

    It is tried in a process of its own: a broken native library may take the whole interpreter with it.
    """
    fault = _import_fault(name, python)
    if fault:
        values = {"name": name, "used_for": used_for, "fault": fault, "python": python}
        return Finding(FindingCode.PACKAGE_MISSING, Status.MISSING, values)
    return Finding(FindingCode.PACKAGE, Status.OK, {"name": name, "used_for": used_for, "version": version(name)})


def _import_fault(name: str, python: str) -> str:
    """Last line of what went wrong; empty when nothing did."""
    try:
        trial = subprocess.run([python, "-c", f"import {name}"], capture_output=True, text=True, check=False)
    except OSError as error:
        return f"Python could not be started: {error}"
    if trial.returncode == 0:
        return ""
    said = trial.stderr.strip().splitlines()
    return said[-1] if said else f"the import ended with code {trial.returncode}"
