"""The part inside the machine runs one command as a shell would, within its time."""

import json
import subprocess
import sys

import pytest

from tests.hil.machine.task import INSIDE

# The interfaces need a machine; the command does not.
_RUN_ONLY = "import inside, json, sys; sys.exit(inside.run(json.loads(sys.argv[1])))"


def run(*command: str, limit_s: float = 60.0) -> "subprocess.CompletedProcess[str]":
    task = {
        "command": command,
        "environment": {"PATH": "/usr/bin:/bin"},
        "directory": "/",
        "limit_s": limit_s,
        "stdout": None,
        "stderr": None,
        "prefix": [],
    }
    return subprocess.run(
        [sys.executable, "-c", _RUN_ONLY, json.dumps(task)],
        cwd=INSIDE.parent,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize(
    ("command", "status"),
    [(("true",), 0), (("sh", "-c", "exit 7"), 7), (("sh", "-c", "kill -9 $$"), 137), (("nosuch",), 127), (("/",), 126)],
)
def test_the_exit_status_is_what_a_shell_would_give(command: tuple[str, ...], status: int) -> None:
    assert run(*command).returncode == status


# Both end only because no process is left that holds the output open.
def test_run_command_over_its_limit_ends_with_its_children() -> None:
    done = run("sh", "-c", "sleep 1000 & wait", limit_s=0.3)
    assert done.returncode == 124
    assert " 0.3 s\n" in done.stderr


def test_run_children_left_by_a_command_end_with_it() -> None:
    assert run("sh", "-c", "sleep 1000 &").returncode == 0
