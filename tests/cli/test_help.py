import subprocess
import sys
from collections.abc import Iterator

import pytest
import typer

from kurt2rt.cli.main import command_line
from tests.cli.helpers import CommandLine


def commands() -> dict[tuple[str, ...], list[str]]:
    """Every command by its words, with the names of its options and arguments."""
    return {
        words: [name for each in getattr(command, "params") for name in _names(each)]  # noqa: B009
        for words, command in _found()
    }


def _found() -> Iterator[tuple[tuple[str, ...], object]]:
    waiting: list[tuple[tuple[str, ...], object]] = [((), typer.main.get_command(command_line(())))]
    while waiting:
        words, command = waiting.pop()
        yield words, command
        waiting += [((*words, name), each) for name, each in getattr(command, "commands", {}).items()]


def _names(parameter: object) -> list[str]:
    opts: list[str] = parameter.opts  # type: ignore[attr-defined]  # of click or of typer, by typer's version
    return opts


def test_every_command_is_found() -> None:
    assert {words[-1] for words in commands() if words} == {
        *(
            "demo",
            "run",
            "status",
            "sim",
            "teach",
            "pair",
            "lesson",
            "exam",
            "paper",
            "phases",
            "replay",
            "knowledge",
            "show",
            "lessons",
            "check",
            "undo",
            "redo",
            "list",
            "branch",
            "merge",
            "diff",
            "export",
            "import",
            "compact",
            "key",
            "table",
            "graph",
            "surprise",
            "faults",
            "soak",
            "why",
            "recover",
            "bench",
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
        (line, *_) = [line for line in said.out.splitlines() if line.startswith("│") and f" {name} " in line]
        explained = line.strip("│ ").split(name, 1)[1]
        assert len(explained.split()) > 2, f"{' '.join(words)} {name} is not explained"


def test_a_robot_without_simulator_page_and_plots_is_helped() -> None:
    extras = ("matplotlib", "pymunk", "jinja2", "shapely", "PIL", "contourpy", "starlette", "uvicorn")
    without = f"import sys; sys.modules.update(dict.fromkeys({extras})); sys.argv = ['kurt2rt', '--help']"
    command = [sys.executable, "-c", f"{without}; from kurt2rt.cli.main import main; main()"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert "lesson" in done.stdout


def test_help_says_which_behaviour_the_scripted_teacher_begins_with(kurt2rt: CommandLine) -> None:
    told = " ".join(kurt2rt("run", "--help").out.replace("│", "").split())
    assert "wanted at the start" in told
    assert "with --auto the others follow in turn" in told
