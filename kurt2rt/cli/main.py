"""`kurt2rt`: the command line."""

import errno
import os
import sys
from collections.abc import Sequence
from importlib import import_module, metadata
from typing import Annotated, Any, NoReturn

import typer
from rich.console import Console
from threadpoolctl import threadpool_limits
from typer.core import TyperGroup

from hal.bus import BusError
from hal.settings import SettingsError
from kurt2rt.channel.error import ChannelError
from kurt2rt.experiments.error import JobKilledError, LessonLostError, StudyError
from kurt2rt.faults.error import DidNotDriveError
from kurt2rt.health.error import StatusError
from kurt2rt.knowledge.error import KnowledgeError
from kurt2rt.layers.basic_level import UnknownActionError, UnknownBehaviourError
from kurt2rt.page.error import PageError
from kurt2rt.recording.error import RecordingError
from kurt2rt.systemd.error import UnitError
from kurt2rt.teaching.answer import NoAnswerError, RefusedError

_EXTRAS = {
    "contourpy": "simulation",
    "jinja2": "simulation",
    "PIL": "simulation",
    "pymunk": "simulation",
    "matplotlib": "simulation",
    "shapely": "simulation",
    "starlette": "page",
    "uvicorn": "page",
    "websockets": "page",
}
"""Packages that a robot can do without, and the extra that brings each."""

_ONE_LINERS = (
    SettingsError,
    KnowledgeError,
    UnknownActionError,
    UnknownBehaviourError,
    BusError,
    JobKilledError,
    LessonLostError,
    ChannelError,
    NoAnswerError,
    RefusedError,
    PageError,
    RecordingError,
    UnitError,
    DidNotDriveError,
    StudyError,
    StatusError,
)
"""Errors whose message tells the user what, where and what to do."""

_MENDED_BY_ANOTHER_PATH = {
    errno.EACCES,
    errno.EDQUOT,
    errno.EEXIST,
    errno.EISDIR,
    errno.ENAMETOOLONG,
    errno.ENOENT,
    errno.ENOSPC,
    errno.ENOTDIR,
    errno.EPERM,
    errno.EROFS,
}

_PANELS = {
    "Teach": ("run", "teach", "pair", "demo", "lesson"),
    "Examine": ("exam", "why", "replay", "recover"),
    "Knowledge": ("knowledge",),
    "Robot and service": ("status", "doctor", "sim", "commission", "service"),
    "Studies": ("paper", "phases", "surprise", "faults", "soak", "bench"),
}
"""Commands by the group of the help that lists them; each is a function, or a group of its own, of that name in its
module of kurt2rt.cli."""

_PANEL_OF = {name: panel for panel, names in _PANELS.items() for name in names}

_WITHOUT_COMMANDS = ("--version", "--show-completion", "--install-completion")
"""Options of kurt2rt itself that no command is loaded for."""


_HELP = (
    "Teach the mobile robot KURT2 by showing it what to do, one situation at a time.\n\n"
    "Begin with `kurt2rt run --page`: a simulated robot stands there and asks you what to do. `kurt2rt demo` lets a "
    "scripted teacher teach it wall following and examines it, in a minute. "
    "`kurt2rt doctor` says what this machine offers for the real one."
)

_USAGE_ERROR: type[Exception] = next(each for each in typer.BadParameter.__mro__ if each.__name__ == "ClickException")
"""Base of all that the parser refuses: click's, or typer's own copy of it, by typer's version."""


class _CommandGroup(TyperGroup):
    """All commands, listed in the order of their panels."""

    def list_commands(self, ctx: Any) -> list[str]:  # noqa: ARG002 - a context of click or of typer
        """Names of the commands that were loaded."""
        return [name for name in _PANEL_OF if name in self.commands]


def command_line(words: Sequence[str]) -> typer.Typer:
    """The commands, or only the one that `words` begin with.

    Each brings its own packages, and as long as a robot's program takes to start, the robot stands.
    """
    app = typer.Typer(cls=_CommandGroup, no_args_is_help=True, pretty_exceptions_enable=False)
    app.callback(help=_HELP)(_options)  # a group, also where there is but one command
    for name in _needed(words):
        command = getattr(import_module(f"kurt2rt.cli.{name}"), name)
        if isinstance(command, typer.Typer):
            app.add_typer(command, name=name, rich_help_panel=_PANEL_OF[name])
        else:
            app.command(name, rich_help_panel=_PANEL_OF[name])(command)
    return app


def _needed(words: Sequence[str]) -> Sequence[str]:
    """Names of the commands to load for `words`."""
    if words and words[0] in _PANEL_OF:
        return words[:1]
    return () if words and words[0].startswith(_WITHOUT_COMMANDS) else tuple(_PANEL_OF)


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


def _typed() -> list[str]:
    """The words after `kurt2rt`: of the command line, or of the line that a shell asks to complete.

    There the first one may be unfinished, and stands for all commands.
    """
    if "_KURT2RT_COMPLETE" not in os.environ:
        return sys.argv[1:]
    words = os.environ.get("COMP_WORDS", os.environ.get("_TYPER_COMPLETE_ARGS", "")).split()[1:]
    return words if len(words) > 1 else []


def main() -> None:
    """Run the command line; what a user can mend is said in one line on standard error, exit code 2."""
    # One thread: a product with some hundred rows is over before a second one wakes, and the loop needs its core.
    with threadpool_limits(limits=1):
        try:
            sys.exit(command_line(_typed())(standalone_mode=False))
        except ModuleNotFoundError as error:
            extra = _EXTRAS.get(error.name or "")
            if extra is None:
                raise
            _complain(f"{error.name} is not installed; this command needs it: pip install 'kurt2rt[{extra}]'")
        except typer.Abort:
            _complain("aborted; nothing more was done", 1)
        except (_USAGE_ERROR, *_ONE_LINERS, OSError, BaseExceptionGroup) as error:
            text = _misuse(error) if isinstance(error, _USAGE_ERROR) else _in_one_line(error)
            if text is None:
                raise
            _complain(text)


def _misuse(error: Any) -> str:
    """Return what the parser refuses, and which help explains it."""
    told = " ".join(error.format_message().split())
    context = getattr(error, "ctx", None)
    if type(error).__name__ == "NoArgsIsHelpError":  # rich has printed the help
        sys.exit(2)
    where = "kurt2rt" if context is None else context.command_path
    return f"{told.rstrip('.')}; see {where} --help"


def _in_one_line(error: BaseException) -> str | None:
    """What is wrong and what to do; None when the user cannot mend it."""
    whose = "".join(f"{note}: " for note in getattr(error, "__notes__", ()))  # one of many jobs
    if isinstance(error, BaseExceptionGroup):
        # A task group wraps even the one error that ended it. A disk that fails ends several tasks at once.
        texts = dict.fromkeys(_in_one_line(each) for each in _leaves(error))
        return None if None in texts else whose + "; ".join(map(str, texts))
    if isinstance(error, _ONE_LINERS):
        return f"{whose}{error}"
    if isinstance(error, OSError) and error.errno in _MENDED_BY_ANOTHER_PATH:
        return f"{whose}{error}; give a path that can be written, on a disk with room"
    return None


def _leaves(group: BaseExceptionGroup[BaseException]) -> list[BaseException]:
    leaves: list[BaseException] = []
    for error in group.exceptions:
        leaves += _leaves(error) if isinstance(error, BaseExceptionGroup) else [error]
    return leaves


def _complain(text: str, code: int = 2) -> NoReturn:
    Console(stderr=True, highlight=False).print(f"kurt2rt: {text}", style="red", markup=False, soft_wrap=True)
    sys.exit(code)


if __name__ == "__main__":
    main()
