"""Output of `kurt2rt run`: a terminal with lines that stay in place, a plain stream, or systemd's journal."""

import os
import re
import shutil
import subprocess
import threading
from collections.abc import Mapping
from html import escape
from pathlib import Path

from rich.console import Console

from hal.health import Health
from kurt2rt.cli.live_screen import LiveScreen
from kurt2rt.platform.text_table import print_lines
from kurt2rt.service.health.snapshot import format_activity
from kurt2rt.service.post_tick import ProgramStatus
from kurt2rt.service.status_line import (
    format_alarms,
    format_guard,
    format_numbers,
    format_problems,
    format_timed_activity,
    status_line,
)
from kurt2rt.teacher.page.served_pages import NO_PAGES, PageAddress, ServedPages, from_line

_LEVELS = {"red": "<3>", "yellow": "<5>"}
"""Levels of systemd's journal, by the style of a line."""
_OPENERS = ("xdg-open", "gio")
_FILE = "open.html"
_DISPLAYS = ("DISPLAY", "WAYLAND_DISPLAY")
_REMOTE = ("SSH_CONNECTION", "SSH_TTY")


class TerminalScreen:
    """Output of `kurt2rt run` on a terminal, a pipe or systemd's journal.

    It is a kurt2rt.service.program_screen.ProgramScreen.
    """

    def __init__(
        self, console: Console, devices: Path, *, as_service: bool = False, phones: bool = False, browser: bool = False
    ) -> None:
        """Write to a console.

        Args:
            console: terminal, pipe or journal.
            devices: folder of the keys of this machine's devices, for the file that opens the browser.
            as_service: a service manager started the program; the log then gets changes only.
            phones: while no device is paired, say how to pair one.
            browser: open the page in the desktop's browser, if the console is a terminal.
        """
        self._console = console
        self._devices = devices
        self._as_service = as_service
        self._browser = browser
        live = console.is_terminal and not console.is_dumb_terminal and not as_service
        self._live = LiveScreen(console, for_phones=phones) if live else None
        self._to_journal = not live and "JOURNAL_STREAM" in os.environ
        self._pages = NO_PAGES
        self._alarm = ""

    @property
    def links(self) -> tuple[str, ...]:
        """Links to the teacher's page, with their tokens."""
        return tuple(each.link for each in self._pages.addresses)

    def print_line(self, text: str, style: str | None = None) -> None:
        """Print a line. `style`: red for an error, yellow for a warning, another colour of rich, or None."""
        level = _LEVELS.get(style or "", "") if self._to_journal else ""
        print_lines(self._console, f"{level}{text}", style=style)

    def lesson_saved(self, text: str) -> None:
        """Print the text of a durable lesson, on a live terminal only."""
        if self._live is not None:
            self.print_line(text, "green")

    def show_status(self, status: ProgramStatus, health: Health, trouble: str) -> None:
        """Show the status; `trouble` is a fault of simulator or CAN log, empty without one."""
        more = [trouble] if trouble else []
        if self._live is not None:
            wrong = [*format_alarms(status, health), *more]
            behind = " | ".join(each.strip() for each in (*format_numbers(status), *format_guard(status)))
            self._live.show(format_timed_activity(status), behind, wrong)
            held = [format_activity(status.record)] if status.record.guard_result.latched else []
            self._print_alarm(" | ".join([*held, *wrong]), "yellow")
        elif self._as_service:
            # The log gets changes only; the present status is the unit's.
            stands = [format_activity(status.record)] if status.runtime.handler.stops.active else []
            told = " | ".join([*stands, *format_problems(status, health), *more])
            self._print_alarm(told, None if stands else "red")
        else:
            self.print_line(status_line(status, health, trouble))

    def page_line(self, line: str) -> None:
        """Handle a line of the page's program: the pages that it serves, or a message."""
        pages = from_line(line)
        if pages is None:
            self.print_line(line, "yellow")
        else:
            self._pin(pages)

    def close(self) -> None:
        """Remove the lines in place from the terminal."""
        if self._live is not None:
            self._live.close()

    def _pin(self, pages: ServedPages) -> None:
        before, self._pages = self._pages, pages
        if self._live is not None:
            self._live.pin(pages)
            # The first report with an address opens the browser; the folder of keys may be unreadable before.
            if self._browser and pages.addresses and not before.addresses and has_desktop():
                self._open_browser(pages.addresses[0])
            return
        for each in pages.addresses:
            if each not in before.addresses:
                self.print_line(f"page for {each.device}:")
                self.print_line(each.link)
        if pages.trouble and pages.trouble != before.trouble:
            self.print_line(pages.trouble, "yellow")

    def _open_browser(self, page: PageAddress) -> None:
        try:
            open_link(page.link, self._devices / page.device)
        except OSError as error:
            self.print_line(f"the browser was not opened ({error}); open {page.link}", "yellow")

    def _print_alarm(self, told: str, style: str | None) -> None:
        """Print the faults, in `style`, if they changed in more than their numbers."""
        if _without_numbers(told) != _without_numbers(self._alarm):
            self.print_line(told or "nothing is wrong any more", style if told else None)
        self._alarm = told


def _without_numbers(text: str) -> str:
    return re.sub(r"\d+", "", text)


def has_desktop(environment: Mapping[str, str] = os.environ) -> bool:
    """Return whether the session has a local display."""
    return any(map(environment.get, _DISPLAYS)) and not any(map(environment.get, _REMOTE))


def open_link(link: str, folder: Path) -> bool:
    """Start to open a link in the browser; return False if no program for that is installed.

    The link carries the token, and all users can read a program's arguments: it is passed in a file in `folder` that
    only this user can read. Raises OSError if the file cannot be written.
    """
    file = folder / _FILE
    write_private(
        file, f'<!doctype html><meta http-equiv="refresh" content="0;url={escape(link)}"><title>kurt2rt</title>'
    )
    return open_file(file)


def write_private(file: Path, content: str) -> None:
    """Write a text file that only this user can read, instead of the one before. Raises OSError."""
    file.unlink(missing_ok=True)
    with os.fdopen(os.open(file, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w", encoding="utf-8") as opened:
        opened.write(content)


def open_file(file: Path) -> bool:
    """Start to open a file in the desktop's browser; return False if no program for that is installed."""
    opener = next((path for path in map(shutil.which, _OPENERS) if path is not None), None)
    if opener is None:
        return False
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
