"""Ctrl-C before a command is under way, and in the middle of one: no traceback, exit code 130."""

import re
import subprocess
import sys

import pytest

from tests.cli.helpers import CommandLine

_INTERRUPTED = """
import os, signal, sys
from importlib.abc import MetaPathFinder

class Interrupt(MetaPathFinder):
    # A package that prints what comes up in its middle, as numpy and others do, and goes on.
    def find_spec(self, name, path, target=None):
        if name == at:
            try:
                os.kill(os.getpid(), signal.SIGINT)
                sum(range(1000))
            except KeyboardInterrupt as error:
                print("a package met", repr(error), file=sys.stderr)

at = sys.argv.pop(1)
sys.meta_path.insert(0, Interrupt())
from kurt2rt.cli.main import main
main()
"""


@pytest.mark.parametrize(
    ("at", "words"),
    [
        ("typer", ["--help"]),
        ("kurt2rt.cli.run", ["run"]),
        ("kurt2rt.service.program", ["run"]),
        ("kurt2rt.cli.teach", ["teach"]),
    ],
)
def test_interrupt_while_packages_are_imported_ends_at_once(at: str, words: list[str]) -> None:
    done = subprocess.run(
        [sys.executable, "-c", _INTERRUPTED, at, *words], capture_output=True, text=True, check=False, timeout=60
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "")


@pytest.mark.parametrize("study", ["phases", "paper"])
def test_interrupt_in_a_study_says_how_it_goes_on(
    kurt2rt: CommandLine, monkeypatch: pytest.MonkeyPatch, study: str
) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("kurt2rt.cli.study_run.run_missing", interrupted)
    said = kurt2rt("study", study, "--quick", "--out", "made")
    assert (said.exit_code, said.out) == (130, "")
    assert re.search(r"interrupted after 0 of \d+ jobs; the same command goes on from there \(made\)", said.err)


def test_interrupt_in_a_command_leaves_no_traceback(kurt2rt: CommandLine, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("kurt2rt.cli.doctor.run_checks", interrupted)
    said = kurt2rt("doctor")
    assert (said.exit_code, said.out, said.err) == (130, "", "")
