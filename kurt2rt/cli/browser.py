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
    """Return whether a person sits before a display of this machine."""
    return any(map(environment.get, _DISPLAYS)) and not any(map(environment.get, _REMOTE))


def open_link(link: str, folder: Path) -> bool:
    """Open a link in the browser, without waiting for it; return whether there is a program that opens one.

    The link is handed on in a file in `folder` that only this user can read: arguments of a program are open to all
    users of the machine, and the link carries the token. Raises OSError when the file cannot be written.
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
    # A thread waits for it, which would else stay a zombie.
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
