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


def test_every_command_is_found() -> None:
    assert {words[-1] for words in commands() if words} == {
        *(
            "demo",
            "run",
            "ros",
            "status",
            "sim",
            "teach",
            "pair",
            "lesson",
            "exam",
            "paper",
            "phases",
            "study",
            "replay",
            "knowledge",
            "plugin",
            "new",
            "show",
            "lessons",
            "check",
            "undo",
            "redo",
            "list",
            "merge",
            "diff",
            "export",
            "lerobot",
            "import",
            "contradictions",
            "table",
            "graph",
            "transfer",
            "compare",
            "doubt",
            "certify",
            "worker",
            "search",
            "why",
            "recover",
            "doctor",
            "commission",
            "service",
            "install",
            "uninstall",
        )
    }
    assert "--seeds" in commands()["lesson",]
    assert "--limit" in commands()["knowledge", "show"]


def test_help_fits_a_terminal_of_80_columns_as_it_was_written() -> None:
    for words, command in _found():
        if not words:
            continue  # of one paragraph, which the terminal breaks
        written = str(getattr(command, "help") or "").splitlines()[1:]  # noqa: B009
        assert [line for line in written if len(line) > 78 and line[0] != " "] == [], words


@pytest.mark.parametrize(("words", "names"), commands().items(), ids=lambda value: " ".join(value))
def test_help_mentions_every_option_and_explains_it(
    kurt2rt: CommandLine, monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...], names: list[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.setattr("typer.rich_utils.MAX_WIDTH", 200)
    said = kurt2rt(*words, "--help")
    assert said.exit_code == 0
    assert said.err == ""
    for name in names:
        lines = [line.replace("... ", " ") for line in said.out.splitlines() if line.startswith("│")]
        (line, *_) = [line for line in lines if f" {name} " in line]
        explained = line.strip("│ ").split(name, 1)[1]
        assert len(explained.split()) > 2, f"{' '.join(words)} {name} is not explained"


def test_a_robot_without_simulator_page_and_plots_is_helped() -> None:
    extras = (
        "matplotlib",
        "pymunk",
        "scipy",
        "jinja2",
        "shapely",
        "PIL",
        "contourpy",
        "starlette",
        "uvicorn",
        "optuna",
    )
    without = f"import sys; sys.modules.update(dict.fromkeys({extras})); sys.argv = ['kurt2rt', '--help']"
    command = [sys.executable, "-c", f"{without}; from kurt2rt.cli.main import main; main()"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert "lesson" in done.stdout


def test_run_help_says_that_auto_cycles_the_behaviours(kurt2rt: CommandLine) -> None:
    told = " ".join(kurt2rt("run", "--help").out.replace("│", "").split())
    assert "with --auto" in told


def test_version_is_that_of_the_installed_package(kurt2rt: CommandLine) -> None:
    said = kurt2rt("--version")
    assert (said.exit_code, said.out, said.err) == (0, f"kurt2rt {metadata.version('kurt2rt')}\n", "")


def test_help_lists_each_command_in_one_panel(kurt2rt: CommandLine) -> None:
    lines = kurt2rt("--help").out.splitlines()
    panels = [line.strip("╭─╮ ") for line in lines if line.startswith("╭")]
    assert len(lines) <= 50  # one screen
    assert panels == ["Options", "Teach", "Examine", "Knowledge and plug-ins", "Robot and service", "Studies"]


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_script_is_shown_for_each_shell(
    kurt2rt: CommandLine, monkeypatch: pytest.MonkeyPatch, shell: str
) -> None:
    monkeypatch.setattr("typer.completion._get_shell_name", lambda: shell)
    said = kurt2rt("--show-completion")
    assert said.exit_code == 0
    assert "_KURT2RT_COMPLETE" in said.out


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
    "numpy",
    "can",
    "cantools",
    "aiocoap",
    "anyio",
    "cryptography",
    "matplotlib",
    "pymunk",
    "scipy",
    "segno",
    "starlette",
)
"""Packages that take most of the import time."""
OUR_PACKAGES = ("hal.settings", "hal.bus", "behaviors", "simbridge", "kurt2rt.runtime", "kurt2rt.service.settings")


@pytest.mark.parametrize("words", [["--help"], ["run", "--help"]], ids=" ".join)
def test_help_imports_nothing_of_what_a_command_needs(words: list[str]) -> None:
    tell = "import atexit, sys; atexit.register(lambda: print(*sys.modules, file=sys.stderr))"
    command = [sys.executable, "-c", f"{tell}; sys.argv[1:] = {words}; from kurt2rt.cli.main import main; main()"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    imported = set(done.stderr.split())
    assert "typer" in imported
    assert imported.isdisjoint({*HEAVY, *OUR_PACKAGES})


def test_the_list_of_commands_says_what_each_says_of_itself() -> None:
    listed, whole = (getattr(typer.main.get_command(command_line(words)), "commands") for words in ((), None))  # noqa: B009
    assert [*listed] == [name for name in listed if name in whole]
    first_lines = {name: " ".join(each.help.split("\n\n")[0].split()) for name, each in whole.items()}
    assert {name: each.help for name, each in listed.items()} == first_lines


def test_help_of_each_command_gives_an_example() -> None:
    for words, command in _found():
        told = getattr(command, "help") or ""  # noqa: B009
        if not getattr(command, "commands", None):
            assert (
                f"\n    kurt2rt {' '.join(words)}" in told or f"\n    sudo .venv/bin/kurt2rt {' '.join(words)}" in told
            )


def test_help_hides_what_programs_alone_use(kurt2rt: CommandLine) -> None:
    assert "--while-stdin" not in kurt2rt("teach", "--help").out
