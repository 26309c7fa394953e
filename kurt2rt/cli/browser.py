"""The desktop's browser, opened on the page of this machine."""

import os
import shutil
import subprocess
import threading
from collections.abc import Mapping
from html import escape
from pathlib import Path

_OPENERS = ("xdg-open", "gio")
_FILE = "open.html"
_DISPLAYS = ("DISPLAY", "WAYLAND_DISPLAY")
_REMOTE = ("SSH_CONNECTION", "SSH_TTY")


def has_desktop(environment: Mapping[str, str] = os.environ) -> bool:
    """Return whether the session has a local display."""
    return any(map(environment.get, _DISPLAYS)) and not any(map(environment.get, _REMOTE))


def open_link(link: str, folder: Path) -> bool:
    """Start to open a link in the browser; return False if no program for that is installed.

    The link carries the token, and all users can read a program's arguments: it is passed in a file in `folder` that
    only this user can read. Raises OSError if the file cannot be written.
    """
    opener = next((path for path in map(shutil.which, _OPENERS) if path is not None), None)
    if opener is None:
        return False
    file = folder / _FILE
    file.unlink(missing_ok=True)
    content = f'<!doctype html><meta http-equiv="refresh" content="0;url={escape(link)}"><title>kurt2rt</title>'
    with os.fdopen(os.open(file, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w", encoding="utf-8") as opened:
        opened.write(content)
    words = (opener, "open", file.absolute().as_uri()) if opener.endswith("gio") else (opener, file.absolute().as_uri())
    # The thread waits for the process, which would otherwise stay a zombie.
    threading.Thread(target=_run, args=(words,), name="browser", daemon=True).start()
    return True


def _run(words: tuple[str, ...]) -> None:
    subprocess.run(
        words,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
        check=False,
    )
