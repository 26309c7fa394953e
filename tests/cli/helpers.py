"""The command line as a user meets it."""

import io
import os
import signal
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import pytest

from config.settings import SettingsError
from config.settings_files import find_config
from kurt2rt.cli.main import main
from tests.forked_program import ForkedProgram, has_fork_server

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True)
class Said:
    """Exit code and output of a command."""

    exit_code: int
    out: str
    err: str


class CommandLine:
    """Runs `kurt2rt ...` in this process through its entry point, which takes a tenth of the time of a new one."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
        monkeypatch.delenv("COLUMNS", raising=False)  # as in a pipe: as wide as it takes
        self._monkeypatch = monkeypatch
        self._capfd = capfd

    def __call__(self, *words: str | Path, typed: io.StringIO | None = None) -> Said:
        """`typed`: what stands at its standard input; nothing, and no terminal, unless given."""
        self._monkeypatch.setattr(sys, "argv", ["kurt2rt", *map(str, words)])
        self._monkeypatch.setattr(sys, "stdin", typed or io.StringIO())
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
        assert "Traceback" not in said.out
        return _one_line(said)

    def misused(self, *words: str | Path) -> str:
        """Run what no command understands; returns the one line that says why and which help to read."""
        said = self(*words)
        assert said.out == ""
        line = _one_line(said)
        assert line.endswith(" --help"), line
        return line


def _one_line(said: Said) -> str:
    lines = [line for line in said.err.splitlines() if line.strip()]
    assert said.exit_code == 2, said.err
    assert len(lines) == 1, said.err
    assert lines[0].startswith("kurt2rt: "), said.err
    return lines[0]


def unknown_name(kind: str, name: str) -> str:
    """Return the error of a name that no settings file of `config/<kind>` has."""
    with pytest.raises(SettingsError) as refused:
        find_config(kind, name)
    return str(refused.value)


_OLD_PICTURE = "what you saw of the robot was old"


class Running:
    """A `kurt2rt ...` that runs as a process of its own."""

    def __init__(self, process: "subprocess.Popen[str] | ForkedProgram") -> None:
        self.process = process
        self._seen: list[str] = []

    def wait_for(self, *texts: str) -> str:
        """Read on until a line holds one of the texts; returns that line."""
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self._seen.append(line)
            if any(text in line for text in texts):
                return line
        raise AssertionError(f"{texts} was never said: {''.join(self._seen)} {self.process.communicate()[1]}")

    def ask(self, line: str, answer: str) -> None:
        """Type a line until it is answered so: on a busy machine a picture is at times too old to move the robot."""
        said = ""
        while answer not in said:
            self.type(line)
            said = self.wait_for(answer, _OLD_PICTURE)

    def type(self, line: str) -> None:
        """Type a line at its keyboard."""
        assert self.process.stdin is not None
        print(line, file=self.process.stdin, flush=True)

    def stop_reading(self) -> None:
        """Close the terminal that it prints to."""
        assert self.process.stdout is not None
        self.process.stdout.close()

    def end(self, number: signal.Signals) -> Said:
        """Send a signal and wait for the end."""
        assert self.process.stdout is not None
        assert self.process.stderr is not None
        self.process.send_signal(number)
        if not self.process.stdout.closed:
            self._seen += self.process.stdout.readlines()
        err = self.process.stderr.read()
        return Said(self.process.wait(), "".join(self._seen), err)


@contextmanager
def running(
    *words: str,
    folder: Path,
    environment: Mapping[str, str] = MappingProxyType({}),
    fresh: bool = False,
    module: str = "kurt2rt.cli.main",
) -> Iterator[Running]:
    """Start `kurt2rt ...` in a folder, with this in its environment, too; what is left of it at the end is killed.

    `fresh`: with an interpreter of its own; else it is forked from one that has imported everything, if there is one.
    `module`: another program than that of `kurt2rt`.
    """
    with started(module, *words, folder=folder, environment=environment, fresh=fresh) as process:
        try:
            yield Running(process)
        finally:
            process.kill()


def started(
    module: str, *words: str, folder: Path, environment: Mapping[str, str] = MappingProxyType({}), fresh: bool = False
) -> "subprocess.Popen[str] | ForkedProgram":
    """Start `python -m MODULE ...`; the rest as `running` says."""
    environment = {**os.environ, "PYTHONUNBUFFERED": "1", **environment}
    if has_fork_server() and not fresh:
        return ForkedProgram(module, words, folder, environment)
    return subprocess.Popen(
        [sys.executable, "-m", module, *words],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=folder,
        env={"PYTHONPATH": str(ROOT), **environment},
    )


def results_in(folder: str) -> dict[str, bytes]:
    """Contents of all results but witnesses, by their path in the folder."""
    paths = Path(folder, "results").rglob("*.json")
    return {str(path.relative_to(folder)): path.read_bytes() for path in paths if "witnesses" not in path.parts}
