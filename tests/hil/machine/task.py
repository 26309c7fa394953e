"""The task that inside.py finds: an order as a file."""

import json
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from tests.hil.machine.inside import NO_MACHINE, TIME_LIMIT
from tests.hil.machine.order import Order
from tests.hil.machine.packages import SEARCH_PATH

INSIDE = Path(__file__).with_name("inside.py")
INTERPRETER = (sys.executable, "-I")

__all__ = ["INSIDE", "INTERPRETER", "NO_MACHINE", "TIME_LIMIT", "write_task"]


def write_task(
    path: Path,
    order: Order,
    *,
    prefix: Sequence[str] = (),
    own_sys: bool = False,
    stdout: str | None = None,
    stderr: str | None = None,
    status: str | None = None,
) -> None:
    """Write the task of an order; the rest as inside.py says. The file is the user's alone: it holds the environment.

    Raises OSError.
    """
    task = {
        "command": order.command,
        "environment": {**os.environ, "PATH": SEARCH_PATH},
        "directory": str(Path.cwd()),
        "interfaces": order.interfaces,
        "limit_s": order.limit_s,
        "prefix": list(prefix),
        "own_sys": own_sys,
        "stdout": stdout,
        "stderr": stderr,
        "status": status,
    }
    path.touch(mode=0o600)
    path.write_text(json.dumps(task), encoding="utf-8")
