"""Verification of a unit by systemd's own tools: whether it loads, and its exposure."""

import re
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from kurt2rt.service.systemd.unit import Unit
from kurt2rt.service.systemd.unit_error import UnitCode, UnitError

TOOL = "systemd-analyze"
MOST_EXPOSURE = 2.0
"""Highest exposure of 10 by `systemd-analyze security`; the unit needs CAN, network and real-time priority."""
_LONGEST_S = 60.0
_OVERALL = re.compile(r"Overall exposure level.*: ([\d.]+)")
_OPEN = re.compile(r"^✗ (\S+)\s+(.*?)\s+([\d.]+)\s*$", re.MULTILINE)


class OpenSetting(NamedTuple):
    """Setting of the unit that leaves something open, in the words of `systemd-analyze security`."""

    setting: str
    meaning: str
    share: float
    """Share of the exposure, in points of 10."""

    def __str__(self) -> str:
        return f"{self.setting} {self.meaning} ({self.share})"


@dataclass(frozen=True, slots=True)
class UnitVerification:
    """Result of systemd's own checks of a unit."""

    complaints: tuple[str, ...]
    """Lines of `systemd-analyze verify`; empty if the unit loads."""
    exposure: float
    """Exposure, 0 to 10; smaller is safer."""
    open: tuple[OpenSetting, ...]

    @property
    def passed(self) -> bool:
        """Return whether the unit loads and its exposure is low enough."""
        return not self.complaints and self.exposure <= MOST_EXPOSURE


def verify(unit: Unit) -> UnitVerification:
    """Verify the unit without installing or starting it. Raises UnitError if the tool is missing."""
    tool = shutil.which(TOOL)
    if tool is None:
        raise UnitError(UnitCode.NO_TOOL, tool=TOOL)
    with tempfile.TemporaryDirectory(prefix="kurt2rt-unit-") as folder:
        path = Path(folder) / f"{unit.name}.service"
        path.write_text(unit.service, encoding="utf-8")
        verified = _say(tool, "verify", "--man=no", str(path))
        security = _say(tool, "security", "--offline=true", "--no-pager", str(path)).stdout
    complaints = tuple(line for line in verified.stderr.splitlines() if path.name in line or verified.returncode)
    overall = _OVERALL.search(security)
    if overall is None:
        raise UnitError(UnitCode.NO_EXPOSURE, tool=TOOL, says=" ".join(security.split())[-200:])
    found = tuple(OpenSetting(setting, meaning, float(share)) for setting, meaning, share in _OPEN.findall(security))
    return UnitVerification(complaints, float(overall[1]), found)


def _say(tool: str, *words: str) -> "subprocess.CompletedProcess[str]":
    try:
        return subprocess.run([tool, *words], capture_output=True, text=True, check=False, timeout=_LONGEST_S)
    except subprocess.TimeoutExpired as error:
        raise UnitError(UnitCode.TOOL_HANGS, tool=TOOL, command=words[0]) from error
