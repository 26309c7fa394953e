"""A story that was put on: what is left of it."""

import json
from pathlib import Path
from typing import Any

from tests.hil.simulated_time.log import Log, read_log


class Played:
    """Everything that the programs told, and what was heard on the bus."""

    def __init__(self, folder: Path) -> None:
        self.candump = (folder / "candump.log").read_bytes()
        self.log: Log = read_log(folder / "candump.log")
        self.robot = (folder / "robot.txt").read_text(encoding="utf-8") if (folder / "robot.txt").exists() else ""
        self.runtime = _told(folder / "runtime.json")
        moments_s = json.loads((folder / "moments.json").read_text(encoding="utf-8"))
        self.moments_us: dict[str, int] = {what: round(at_s * 1e6) for what, at_s in moments_s.items()}
        """When things were done, on the clock of the log."""


def _told(path: Path) -> dict[str, Any]:
    """All lines of a program, as one; empty when it was killed before it told anything."""
    told: dict[str, Any] = {}
    for line in path.read_text(encoding="utf-8").splitlines():
        told |= json.loads(line)
    return told
