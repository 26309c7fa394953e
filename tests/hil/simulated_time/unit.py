"""A unit of the machine's systemd, as a person at its keyboard sees it."""

import json
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

NAME = "kurt2rt"
STATE = Path("/var/lib") / NAME
_LONG_ENOUGH_S = 120.0
_LOOK_S = 0.2


class Unit:
    """kurt2rt.service. Each word raises subprocess.CalledProcessError when systemd refuses."""

    def start(self) -> None:
        """Start the unit; return when its program is ready."""
        _do("systemctl", "start", NAME)

    def stop(self) -> None:
        """Stop the unit; return when its program has ended."""
        _do("systemctl", "stop", NAME)

    def kill(self, signal: str) -> None:
        """Send its main process a signal."""
        _do("systemctl", "kill", "--kill-whom=main", f"--signal={signal}", NAME)

    def shows(self, name: str) -> str:
        """Return a property, as `systemctl show` prints it."""
        return _do("systemctl", "show", "--property", name, "--value", NAME).strip()

    @property
    def pid(self) -> int:
        """Process id of the main process; 0 while there is none."""
        return int(self.shows("MainPID"))

    def journal(self, pid: int | None = None) -> str:
        """Return the journal since the machine's start: of a process, or of the whole unit."""
        which = ("--unit", NAME) if pid is None else (f"_PID={pid}",)
        return _do("journalctl", "--quiet", "--no-pager", "--output", "cat", *which)

    def said_at_s(self, beginning: str) -> float:
        """Return the time of the newest line with this beginning, in seconds of the monotonic clock."""
        lines = _do("journalctl", "--quiet", "--output", "json", "--unit", NAME).splitlines()
        entries = [entry for entry in map(json.loads, lines) if entry["MESSAGE"].startswith(beginning)]
        return int(entries[-1]["__MONOTONIC_TIMESTAMP"]) / 1e6

    def wait_until_said(self, text: str) -> int:
        """Wait until the present or the next program has logged a text; return its process id."""
        self._wait(lambda: (pid := self.pid) != 0 and text in self.journal(pid), f"{text!r} is said")
        return self.pid

    def wait_for_another(self, pid: int) -> None:
        """Wait until the unit has another main process."""
        self._wait(lambda: self.pid not in (0, pid), f"another process than {pid} is there")

    def wait_for_status(self, text: str) -> None:
        """Wait until the status text of the program contains a text."""
        self._wait(lambda: text in self.shows("StatusText"), f"the status says {text!r}")

    def _wait(self, is_so: Callable[[], bool], what: str) -> None:
        until_s = time.monotonic() + _LONG_ENOUGH_S
        while not is_so():
            if time.monotonic() > until_s:
                raise AssertionError(f"it never came that {what}:\n{_do('systemctl', 'status', NAME)}{self.journal()}")
            time.sleep(_LOOK_S)


def _do(*words: str) -> str:
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0 or words[1] == "status", f"{' '.join(words)}: {done.stdout}{done.stderr}"
    return done.stdout
