"""The commands of `kurt2rt`, in groups. The list of all is shown without importing any of them."""

import os
import sys
from collections.abc import Iterator, Sequence
from importlib import import_module, metadata
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from config.errors import ExitCode

_PANELS = {
    "Teach and examine": {
        "demo": "Teach a simulated robot from nothing, then examine it.",
        "run": "Run the robot in real time, until Ctrl-C or SIGTERM.",
        "teach": "Teach a running robot: by browser, terminal or script.",
        "pair": "Pair a teacher's device, and show the code of its page.",
        "train": "Teach simulated robots with a scripted teacher.",
        "exam": "Examine knowledge: a simulated robot drives by itself.",
    },
    "Look back": {
        "why": "Explain what the robot did, and why: in a run, or now.",
        "replay": "Replay a recorded run, and compare it bit for bit.",
        "recording": "List recorded runs, repair or export them.",
        "knowledge": "Look after what the robot was taught: show, undo, merge.",
    },
    "Robot and machine": {
        "doctor": "Check what this machine offers the robot, and what to do.",
        "status": "Tell how a running robot program is.",
        "sim": "Simulate a KURT2 on a CAN bus, in real time.",
        "commission": "Commission a real robot: the checklist of its first day.",
        "service": "Run the robot's program as a unit of systemd.",
        "ros": "Join a running robot to ROS 2, over zenoh, without ROS.",
    },
    "Research and more": {
        "study": "Measure many robots: the paper, phases, new worlds, doubt.",
        "plugin": "List, show and begin plug-ins: parts of other authors.",
        "docs": "List the pages of the documentation, or read one here.",
    },
}
"""Commands by the group of the help that lists them; each is a function, or a group of its own, of that name in its
module of kurt2rt.cli. The first line of its help stands here as well."""

_OPTION_PANELS = {
    "Robot and world": (
        "bus",
        "robots",
        "robot_settings",
        "settings",
        "task",
        "world",
        "behaviour",
        "seed",
        "seeds",
        "seconds",
    ),
    "Teaching": ("teacher", "auto", "knowledge", "terminal", "paper_defaults", "changes"),
    "Page and network": (
        "page",
        "phone",
        "no_open",
        "device",
        "port",
        "page_port",
        "page_address",
        "public_address",
        "robot",
    ),
    "Recording": ("record", "no_record", "can_log", "live_view"),
    "Study": ("jobs", "cluster", "engine", "checkpoint", "out", "quick"),
}
"""Options of long helps, by the title of their panel."""
_LONG_HELP = 10

_PANEL_OF = {name: panel for panel, names in _PANELS.items() for name in names}

_HELP = (
    "Teach the mobile robot KURT2 by showing it what to do, one situation at a time.\n\n"
    "Begin with `kurt2rt run --phone`: a simulated robot stands there and asks you what to do. "
    "`kurt2rt demo` teaches it by itself, in a minute. `kurt2rt docs handbook` has the rest."
)

USAGE_ERROR: type[Exception] = next(each for each in typer.BadParameter.__mro__ if each.__name__ == "ClickException")
"""Base of all that the parser refuses: click's, or typer's own copy of it, by typer's version."""


class _CommandGroup(TyperGroup):
    """All commands, listed in the order of their panels."""

    def list_commands(self, ctx: Any) -> list[str]:  # noqa: ARG002 - a context of click or of typer
        """Names of the commands that were loaded."""
        return [name for name in _PANEL_OF if name in self.commands]

    def get_params(self, ctx: Any) -> list[Any]:
        """Parameters of the group itself."""
        return _arranged(super().get_params(ctx))

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Command of a name, with a help that is easy to read."""
        command = super().get_command(ctx, cmd_name)
        for each in _all_within(command):
            _arranged(each.get_params(ctx))
            if "\n\n" in (each.help or ""):
                each.help += "\n\b"  # a last line at the margin, which shows as none: examples stay indented
        return command


def _all_within(command: Any) -> Iterator[Any]:
    """Yield a command and those below it; None has none."""
    if command is not None:
        yield command
        for each in getattr(command, "commands", {}).values():
            yield from _all_within(each)


def _arranged(parameters: list[Any]) -> list[Any]:
    """Give flags no type, as they take no value, and the options of a long help their panels."""
    panels = {name: panel for panel, names in _OPTION_PANELS.items() for name in names}
    for each in parameters:
        if getattr(each, "is_flag", False):
            each.metavar = ""
        if len(parameters) > _LONG_HELP:
            each.rich_help_panel = panels.get(each.name)
    return parameters


def command_line(words: Sequence[str] | None = None) -> typer.Typer:
    """Return the commands, imported; with `words`, only the command that they begin with.

    Each brings its own packages, and as long as a robot's program takes to start, the robot stands. If `words` begin
    with no command, the commands are listed with their first lines, and none is imported.
    """
    app = typer.Typer(cls=_CommandGroup, no_args_is_help=True, pretty_exceptions_enable=False)
    app.callback(help=_HELP)(_options)  # a group, also where there is but one command
    chosen = [*_PANEL_OF] if words is None else [name for name in words[:1] if name in _PANEL_OF]
    for name in chosen:
        command = getattr(import_module(f"kurt2rt.cli.{name}"), name)
        if isinstance(command, typer.Typer):
            app.add_typer(command, name=name, rich_help_panel=_PANEL_OF[name])
        else:
            app.command(name, rich_help_panel=_PANEL_OF[name])(command)
    for panel, lines in () if chosen else _PANELS.items():
        for name, line in lines.items():
            app.command(name, rich_help_panel=panel, help=line)(lambda: None)
    return app


def _options(
    version: Annotated[
        bool,
        typer.Option(
            "--version", is_eager=True, callback=lambda asked: _print_version(asked), help="Print the version."
        ),
    ] = False,
) -> None:
    """Take the options of kurt2rt itself."""


def _print_version(asked: bool) -> None:
    if asked:
        typer.echo(f"kurt2rt {metadata.version('kurt2rt')}")
        raise typer.Exit


def typed() -> list[str]:
    """Return the words after `kurt2rt`: of the command line, or of the line that a shell asks to complete.

    There the first one may be unfinished, and stands for all commands.
    """
    if "_KURT2RT_COMPLETE" not in os.environ:
        return sys.argv[1:]
    words = os.environ.get("COMP_WORDS", os.environ.get("_TYPER_COMPLETE_ARGS", "")).split()[1:]
    return words if len(words) > 1 else []


def misuse(error: Any) -> str:
    """Return what the parser refuses, and which help explains it."""
    # Without the words of pydantic, which checks some values.
    told = " ".join(error.format_message().split()).replace(": Input should", ": should").replace(": Value error,", ":")
    context = getattr(error, "ctx", None)
    if type(error).__name__ == "NoArgsIsHelpError":  # rich has printed the help
        sys.exit(ExitCode.REFUSED)
    where = "kurt2rt" if context is None else context.command_path
    return f"{told.rstrip('.')}; see {where} --help"
