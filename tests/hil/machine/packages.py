"""Debian packages that the machine needs on this one."""

import os
import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

from tests.hil.machine.trouble import MachineError

# An ordinary user's search path lacks the directories of ip, tc and insmod on Debian.
SEARCH_PATH = f"{os.environ.get('PATH', os.defpath)}:/usr/local/sbin:/usr/sbin:/sbin"


def program(name: str) -> str | None:
    """Full path of a program; None when it is not installed."""
    return shutil.which(name, path=SEARCH_PATH)


def need(packages_by_sign: Mapping[str, str], *, install: bool) -> None:
    """See to it that packages are there, each by its sign: a program's name, or a pattern of a file by full path.

    Raises MachineError that names what is missing and the line that would install it.
    """
    missing = _missing(packages_by_sign)
    if missing and install:
        _install(missing)
        missing = _missing(packages_by_sign)
    if missing:
        names = " ".join(missing)
        raise MachineError(
            f"missing Debian packages: {names}\n"
            f"    apt-get update && apt-get install --no-install-recommends {names}    (as root, or give --install)"
        )


def as_root() -> list[str]:
    """Return the prefix of a command that needs root."""
    return [] if os.geteuid() == 0 else ["sudo", "-n"]


def _missing(packages_by_sign: Mapping[str, str]) -> list[str]:
    return sorted({package for sign, package in packages_by_sign.items() if not _there(sign)})


def _there(sign: str) -> bool:
    if "/" in sign:
        return any(Path("/").glob(sign.lstrip("/")))
    return program(sign) is not None


def _install(packages: list[str]) -> None:
    print(f"machine: installing {' '.join(packages)}", file=sys.stderr, flush=True)
    quiet = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    apt_get = [*as_root(), "apt-get", "-qq"]
    try:
        for step in (["update"], ["install", "-y", "--no-install-recommends", *packages]):
            # What apt-get says is not the command's output.
            subprocess.run([*apt_get, *step], env=quiet, stdin=subprocess.DEVNULL, stdout=sys.stderr, check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        raise MachineError(f"cannot install {' '.join(packages)}: {error}") from error
