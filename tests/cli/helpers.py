"""The command line as a user meets it."""

import io
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from kurt2rt.cli.main import main


@dataclass(frozen=True)
class Said:
    """What a command left on the screen."""

    exit_code: int
    out: str
    err: str


class CommandLine:
    """Runs `kurt2rt ...` in this process through its entry point, which takes a tenth of the time of a new one."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
        self._monkeypatch = monkeypatch
        self._capfd = capfd

    def __call__(self, *words: str | Path) -> Said:
        self._monkeypatch.setattr(sys, "argv", ["kurt2rt", *map(str, words)])
        self._monkeypatch.setattr(sys, "stdin", io.StringIO())
        self._capfd.readouterr()
        exit_code: int | str | None = 0
        try:
            main()
        except SystemExit as end:
            exit_code = end.code
        out, err = self._capfd.readouterr()
        assert isinstance(exit_code, int | None)
        return Said(exit_code or 0, out, err)

    def refused(self, *words: str | Path) -> str:
        """Run what must be refused; returns the one line that says why."""
        said = self(*words)
        lines = [line for line in said.err.splitlines() if line.strip()]
        assert said.exit_code == 2, said.err
        assert len(lines) == 1, said.err
        assert lines[0].startswith("kurt2rt: "), said.err
        assert "Traceback" not in said.out
        return lines[0]

    def misused(self, *words: str | Path) -> str:
        """Run what no command understands; returns what it says about it, on one line and without its frame."""
        said = self(*words)
        assert said.exit_code == 2, said.err
        assert "Traceback" not in said.err
        assert said.out == ""
        return " ".join(said.err.replace("│", "").split())


def start(*words: str | Path, folder: Path) -> "subprocess.Popen[str]":
    """Start `kurt2rt ...` as a process of its own, with nobody at its keyboard."""
    return subprocess.Popen(
        [sys.executable, "-m", "kurt2rt.cli.main", *map(str, words)],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        bufsize=1,
        cwd=folder,
    )
