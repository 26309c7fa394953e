"""`kurt2rt`: the command line.

Imports of the standard library, config.errors and what is small only (interrupt, extras, foreign packages):
Ctrl-C before `main` begins leaves a traceback, and `kurt2rt --help` takes as long as its imports.
"""

import io
import os
import sys
from errno import EACCES, EDQUOT, EEXIST, EIO, EISDIR, ENAMETOOLONG, ENOENT, ENOSPC, ENOTDIR, EPERM, EROFS
from typing import NoReturn

from kurt2rt.platform.own_packages import hidden_packages

if _hidden := hidden_packages():  # before the first import of one of them, which would leave a traceback
    print(f"kurt2rt: {_hidden}", file=sys.stderr)
    sys.exit(2)

from config.errors import ExitCode, UserError
from kurt2rt.cli.interrupt import end_at_interrupt
from kurt2rt.platform.extras import extra_for

_MENDED_BY_ANOTHER_PATH = {EACCES, EDQUOT, EEXIST, EISDIR, ENAMETOOLONG, ENOENT, ENOSPC, ENOTDIR, EPERM, EROFS}

_ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS")
"""numpy's libraries read these when they are loaded."""
_LEAST = {"COLUMNS": 20, "LINES": 5}
"""Smallest sizes that are those of a terminal; some programs set 0 for unknown, and rich then prints nothing."""


def main() -> None:
    """Run the command line and end the process by SystemExit.

    An error that a user can mend is one line on standard error, with exit code 2; Ctrl-C ends with 130.
    """
    # One thread: a product with some hundred rows is over before a second one wakes, and the loop needs its core.
    os.environ.update(dict.fromkeys(_ONE_THREAD, "1"))
    adapt_to_terminal()
    with end_at_interrupt():
        import typer

        from kurt2rt.cli.command_line import USAGE_ERROR, command_line, misuse, typed
    try:
        with end_at_interrupt():
            commands = command_line(typed())
        sys.exit(commands(prog_name="kurt2rt", standalone_mode=False))
    except KeyboardInterrupt:
        sys.exit(ExitCode.INTERRUPTED)
    except ModuleNotFoundError as error:
        extra = extra_for(error)
        if extra is None:
            raise
        _complain(f"{error.name} is not installed; this command needs it: pip install '.[{extra}]' in kurt2rt's folder")
    except typer.Abort:
        _complain("aborted; nothing more was done", ExitCode.FAILED)
    except USAGE_ERROR as error:
        _complain(misuse(error))
    except Exception as error:
        text = _in_one_line(error)
        if text is None:
            raise
        codes = (each.exit_code for each in _leaves(error) if isinstance(each, UserError))
        _complain(text, max(codes, default=ExitCode.REFUSED))
    except BaseExceptionGroup as error:
        if error.subgroup(KeyboardInterrupt) is None:
            raise
        sys.exit(ExitCode.INTERRUPTED)


def _in_one_line(error: BaseException) -> str | None:
    """Return what is wrong and what to do; None if the user cannot mend it."""
    whose = "".join(f"{note}: " for note in getattr(error, "__notes__", ()))  # one of many jobs
    if isinstance(error, BaseExceptionGroup):
        # A task group wraps even the one error that ended it. A disk that fails ends several tasks at once.
        texts = dict.fromkeys(_in_one_line(each) for each in _leaves(error))
        return None if None in texts else whose + "; ".join(map(str, texts))
    if isinstance(error, UserError):
        return f"{whose}{error}"
    if isinstance(error, OSError) and error.errno in _MENDED_BY_ANOTHER_PATH:
        return f"{whose}{error}; give a path that can be written, on a disk with room"
    if isinstance(error, OSError) and error.errno == EIO:
        return f"{whose}{error}; see whether the disk or device is well, or give another file"
    return None


def _leaves(error: BaseException) -> list[BaseException]:
    if not isinstance(error, BaseExceptionGroup):
        return [error]
    return [leaf for each in error.exceptions for leaf in _leaves(each)]


def _complain(text: str, code: ExitCode = ExitCode.REFUSED) -> NoReturn:
    from kurt2rt.cli.tables import say

    say(f"kurt2rt: {text}", "red", stderr=True)
    sys.exit(code)


def adapt_to_terminal() -> None:
    """Let this process print what its terminal can show: ? for other letters, and lines at widths that exist."""
    for stream in (sys.stdin, sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    for name, least in _LEAST.items():
        size = os.environ.get(name, "")
        if size.isdigit() and int(size) < least:
            del os.environ[name]


if __name__ == "__main__":
    main()
