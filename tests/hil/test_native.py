"""Native machine: a namespace of its own on a kernel with vcan, for root and for other users."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.hil

ROOT = Path(__file__).parents[2]
# The virtual environment's interpreter may lie in a user's home.
SYSTEM_PYTHON = shutil.which("python3", path="/usr/local/bin:/usr/bin") or "python3"
AS_NOBODY = ("setpriv", "--reuid=65534", "--regid=65534", "--clear-groups")


def others_exist() -> bool:
    """Return whether this process could become another user; in a user namespace there is none."""
    return os.geteuid() == 0 and int(Path("/proc/self/uid_map").read_text().split()[2]) > 65534


def native(*words: str, interpreter: str = sys.executable, user: tuple[str, ...] = ()) -> str:
    done = subprocess.run(
        [*user, interpreter, "-m", "tests.hil.machine", "--way", "native", *words],
        cwd=ROOT,
        env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    return f"{done.stdout}{done.stderr}exit status {done.returncode}"


@pytest.mark.usefixtures("vcan0")
def test_native_command_has_its_own_bus_and_leaves_vcan0_up() -> None:
    said = native("--interface", "vcan7", "--", "sh", "-c", "ls /sys/class/net; ip link del vcan7; exit 3")
    assert said == "lo\nvcan7\nexit status 3"
    assert int(Path("/sys/class/net/vcan0/flags").read_text(), 16) & 1


@pytest.mark.usefixtures("vcan0")
@pytest.mark.skipif(not others_exist(), reason="this machine is an ordinary user's own already")
def test_an_ordinary_user_has_one_too_and_may_set_its_link() -> None:
    said = native("--", "sh", "-c", "ip link set vcan0 down && echo down", interpreter=SYSTEM_PYTHON, user=AS_NOBODY)
    assert said == "down\nexit status 0"


@pytest.mark.usefixtures("vcan0")
def test_it_is_found_without_being_asked_for() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "tests.hil.machine", "--check"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert done.stdout.startswith("native: ")
