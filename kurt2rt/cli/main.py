"""`kurt2rt`: the command line."""

import errno
import sys
from collections.abc import Sequence
from importlib import import_module
from typing import NoReturn

import typer
from rich.console import Console
from threadpoolctl import threadpool_limits

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

_COMMANDS = (
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
    "why",
    "recover",
    "knowledge",
    "surprise",
    "commission",
    "service",
    "faults",
    "soak",
    "bench",
    "doctor",
)
"""Each is a function, or a group of its own, of that name in its module of kurt2rt.cli."""


_HELP = (
    "Teach the mobile robot KURT2 by showing it what to do, one situation at a time.\n\n"
    "Begin with `kurt2rt run --page`: a simulated robot stands there and asks you what to do. `kurt2rt demo` lets a "
    "scripted teacher teach it wall following and examines it, in a minute. "
    "`kurt2rt doctor` says what this machine offers for the real one."
)


def command_line(words: Sequence[str]) -> typer.Typer:
    """The commands, or only the one that `words` begin with.

    Each brings its own packages, and as long as a robot's program takes to start, the robot stands.
    """
    app = typer.Typer(no_args_is_help=True, add_completion=False, pretty_exceptions_enable=False)
    app.callback(help=_HELP)(lambda: None)  # a group, also where there is but one command
    for name in words[:1] if words and words[0] in _COMMANDS else _COMMANDS:
        command = getattr(import_module(f"kurt2rt.cli.{name}"), name)
        if isinstance(command, typer.Typer):
            app.add_typer(command, name=name)
        else:
            app.command(name)(command)
    return app


def main() -> None:
    """Run the command line; what a user can mend is said in one line, exit code 2."""
    # One thread: a product with some hundred rows is over before a second one wakes, and the loop needs its core.
    with threadpool_limits(limits=1):
        try:
            command_line(sys.argv[1:])()
        except ModuleNotFoundError as error:
            extra = _EXTRAS.get(error.name or "")
            if extra is None:
                raise
            _complain(f"{error.name} is not installed; this command needs it: pip install 'kurt2rt[{extra}]'")
        except (*_ONE_LINERS, OSError, BaseExceptionGroup) as error:
            text = _in_one_line(error)
            if text is None:
                raise
            _complain(text)


def _in_one_line(error: BaseException) -> str | None:
    """What is wrong and what to do; None when the user cannot mend it."""
    whose = "".join(f"{note}: " for note in getattr(error, "__notes__", ()))  # one of many jobs
    if isinstance(error, BaseExceptionGroup):
        # A task group wraps even the one error that ended it.
        errors = _leaves(error)
        text = _in_one_line(errors[0]) if len(errors) == 1 else None
        return None if text is None else f"{whose}{text}"
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


def _complain(text: str) -> NoReturn:
    Console(stderr=True, highlight=False).print(f"kurt2rt: {text}", style="red", markup=False, soft_wrap=True)
    sys.exit(2)


if __name__ == "__main__":
    main()
