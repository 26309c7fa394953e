"""Output on terminals of any encoding and width."""

import codecs
import io
import os
import sys

_PLAIN = {"─": "-", "█": "#", "·": ".", "✗": "x", "µ": "u", "±": "+-", "…": "..."}
_ERRORS = "kurt2rt-plain"
_LEAST = {"COLUMNS": 20, "LINES": 5}
"""Smallest sizes that are those of a terminal; some programs set 0 for unknown, and rich then prints nothing."""


def adapt_to_terminal() -> None:
    """Let this process print what its terminal can show: like letters for others, and lines at widths that exist."""
    codecs.register_error(_ERRORS, _like_letters)
    for stream in (sys.stdin, sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors=_ERRORS)
    for name, least in _LEAST.items():
        size = os.environ.get(name, "")
        if size.isdigit() and int(size) < least:
            del os.environ[name]


def _like_letters(error: UnicodeError) -> tuple[str, int]:
    """Return letters for those that an encoding does not have, a question mark for bytes that are none of it."""
    assert isinstance(error, UnicodeEncodeError | UnicodeDecodeError)
    unknown = error.object[error.start : error.end]
    return "".join(_PLAIN.get(str(each), "?") for each in unknown), error.end
