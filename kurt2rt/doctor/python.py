"""Python itself and the packages that only some commands need."""

import subprocess
import sys
from importlib.metadata import version

from kurt2rt.doctor.finding import Finding, Status

LEAST_PYTHON = (3, 11)


def check_python(found: tuple[int, int, int] = sys.version_info[:3]) -> Finding:
    """Is Python new enough?"""
    name = ".".join(map(str, found))
    if found[:2] < LEAST_PYTHON:
        least = ".".join(map(str, LEAST_PYTHON))
        return Finding(
            "Python", Status.MISSING, name, f"install Python {least} or newer and make a new .venv with it", needed=True
        )
    return Finding("Python", Status.OK, name, needed=True)


def check_package(name: str, used_for: str) -> Finding:
    """Can a package of the `simulation` extra be imported?

    It is tried in a process of its own: a broken native library may take the whole interpreter with it.
    """
    trial = subprocess.run([sys.executable, "-c", f"import {name}"], capture_output=True, text=True, check=False)
    if trial.returncode == 0:
        return Finding(name, Status.OK, f"{version(name)}, for {used_for}")
    said = trial.stderr.strip().splitlines() or [f"the import ended with code {trial.returncode}"]
    return Finding(
        name,
        Status.MISSING,
        f"cannot be imported ({said[-1]}), needed for {used_for}",
        f"{sys.executable} -m pip install 'kurt2rt[simulation]'",
    )
