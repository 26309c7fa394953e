import re
import subprocess
import sys
from collections.abc import Iterator
from importlib import metadata

import pytest
import typer

from kurt2rt.cli.command_line import command_line
from tests.cli.helpers import CommandLine


def commands() -> dict[tuple[str, ...], list[str]]:
    """Every command by its words, with the names of its options and arguments."""
    return {
        words: [name for each in getattr(command, "params") for name in _names(each)]  # noqa: B009
        for words, command in _found()
    }


def _found() -> Iterator[tuple[tuple[str, ...], object]]:
    waiting: list[tuple[tuple[str, ...], object]] = [((), typer.main.get_command(command_line()))]
    while waiting:
        words, command = waiting.pop()
        yield words, command
        waiting += [((*words, name), each) for name, each in getattr(command, "commands", {}).items()]


def _names(parameter: object) -> list[str]:
    """Those that the help shows."""
    opts: list[str] = [] if getattr(parameter, "hidden", False) else getattr(parameter, "opts")  # noqa: B009
    return opts


@pytest.mark.parametrize(("words", "names"), commands().items(), ids=lambda value: " ".join(value))
def test_help_mentions_every_option_and_explains_it(
    kurt2rt: CommandLine, monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...], names: list[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.setattr("typer.rich_utils.MAX_WIDTH", 200)
    said = kurt2rt(*words, "--help")
    assert said.exit_code == 0
    assert said.err == ""
    assert not re.search(r"For example:\s*\n kurt2rt ", said.out), "an example is not indented"
    for name in names:
        lines = [line.replace("... ", " ") for line in said.out.splitlines() if line.startswith("│")]
        (line, *_) = [line for line in lines if f" {name} " in line]
        explained = line.strip("│ ").split(name, 1)[1]
        assert len(explained.split()) > 2, f"{' '.join(words)} {name} is not explained"


def test_help_of_all_commands_fits_a_screen_of_50_lines(kurt2rt: CommandLine, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    assert len(kurt2rt("--help").out.splitlines()) <= 50


def test_version_is_that_of_the_installed_package(kurt2rt: CommandLine) -> None:
    said = kurt2rt("--version")
    assert (said.exit_code, said.out, said.err) == (0, f"kurt2rt {metadata.version('kurt2rt')}\n", "")


@pytest.mark.parametrize(
    ("typed", "offered"), [("kurt2rt exa", "exam"), ("kurt2rt knowledge sh", "show"), ("kurt2rt exam --wor", "--world")]
)
def test_completion_offers_what_was_begun(
    kurt2rt: CommandLine, monkeypatch: pytest.MonkeyPatch, typed: str, offered: str
) -> None:
    monkeypatch.setenv("_KURT2RT_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", typed)
    monkeypatch.setenv("COMP_CWORD", str(len(typed.split()) - 1))
    said = kurt2rt()
    assert (said.exit_code, said.out.split(), said.err) == (0, [offered], "")


HEAVY = (
    *("numpy", "can", "cantools", "aiocoap", "anyio", "cryptography", "matplotlib", "pymunk", "scipy", "segno"),
    "starlette",
)
"""Packages that take most of the import time."""
OUR_PACKAGES = ("config.settings", "hal.bus", "behaviors", "simbridge", "kurt2rt.runtime", "kurt2rt.service.settings")


@pytest.mark.parametrize("words", [["--help"], ["run", "--help"], ["demo", "--help"], ["exam", "--help"]], ids=" ".join)
def test_help_imports_nothing_of_what_a_command_needs(words: list[str]) -> None:
    tell = "import atexit, sys; atexit.register(lambda: print(*sys.modules, file=sys.stderr))"
    command = [sys.executable, "-c", f"{tell}; sys.argv[1:] = {words}; from kurt2rt.cli.main import main; main()"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    imported = set(done.stderr.split())
    assert "typer" in imported
    assert imported.isdisjoint({*HEAVY, *OUR_PACKAGES})


def test_long_help_has_panels_and_flags_take_no_type(kurt2rt: CommandLine) -> None:
    said = kurt2rt("run", "--help").out
    assert [line.strip("╭─╮") for line in said.splitlines() if line.startswith("╭")] == [
        *(" Options ", " Robot and world ", " Teaching ", " Page and network ", " Recording "),
    ]
    assert "<bool>" not in said
