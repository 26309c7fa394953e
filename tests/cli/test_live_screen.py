"""The terminal of `kurt2rt run`: what stays in place, and what is printed above it."""

import io
import math
import os
import stat
from functools import partial
from pathlib import Path

import pytest
from rich.console import Console

from kurt2rt.channel.security.pairing import pair
from kurt2rt.cli.live_screen import LiveScreen
from kurt2rt.cli.terminal_screen import has_desktop
from kurt2rt.core.teaching.question import Question
from kurt2rt.platform.text_table import print_lines
from kurt2rt.teacher.page.served_pages import PageAddress, ServedPages
from tests.cli.pseudo_terminal import ProgramInTerminal, Terminal

LOCAL = PageAddress("local", "http://127.0.0.1:8642/pair?token=" + 32 * "a")
PHONE = PageAddress("phone", "http://192.168.100.100:8642/pair?token=" + 32 * "b")
FULL_BLOCK = "█"


class Shown:
    """A live screen on a terminal of 80 columns."""

    def __init__(self, height: int = 24, *, for_phones: bool = True) -> None:
        self._sent = io.StringIO()
        console = Console(file=self._sent, force_terminal=True, width=80, height=height, _environ={})
        self.screen = LiveScreen(console, for_phones=for_phones)
        self.print = partial(print_lines, console)

    def lines(self) -> list[str]:
        terminal = Terminal()
        terminal.feed(self._sent.getvalue())
        return [line.rstrip() for line in terminal.lines]


def test_the_status_is_rewritten_in_place_and_lines_go_above_it() -> None:
    shown = Shown(for_phones=False)
    shown.print("first")
    shown.screen.pin(ServedPages((LOCAL,), network=False, trouble=""))
    for second in range(5):
        shown.screen.show(f"{second}.0 s  forward", "1 RLAs", [])
        shown.print(f"question {second}")
    address = f"page  {LOCAL.link}"
    assert shown.lines() == ["first", *(f"question {n}" for n in range(5)), address, "4.0 s  forward", "1 RLAs"]
    shown.screen.close()
    shown.print("the robot stands")
    assert [line for line in shown.lines() if line][-2:] == ["question 4", "the robot stands"]
    assert address not in shown.lines()


def test_troubles_stand_below_and_never_beyond_80_columns() -> None:
    shown = Shown(for_phones=False)
    shown.screen.show("1.0 s  stands", "1 RLAs", ["the disk fails; " * 8, "the bus fails"])
    lines = shown.lines()
    assert lines[-1] == "! the bus fails"
    assert all(len(line) <= 80 for line in lines)
    assert " ".join(lines).count("the disk fails") == 8


def test_show_long_status_keeps_the_code_in_24_lines() -> None:
    shown = Shown()
    shown.screen.pin(ServedPages((LOCAL,), network=False, trouble=""))
    assert shown.lines()[-1] == "for a phone: kurt2rt pair phone, in another terminal"
    shown.screen.pin(ServedPages((LOCAL, PHONE), network=True, trouble=""))
    for troubles in ([], ["the disk fails; " * 8, "the bus fails"]):
        shown.screen.show("1.0 s  stands " * 9, "1 RLAs", troubles)
        lines = shown.lines()
        assert sum(line.startswith(2 * FULL_BLOCK) for line in lines) == 18
        *_, page, phone, doing, more = lines
        assert (page, phone) == (f"page   {LOCAL.link}", f"phone  {PHONE.link}")
        assert (len(doing), doing[-1]) == (80, "…")
        assert more.startswith("! the disk fails" if troubles else "1 RLAs")
        assert len(lines) <= 24


def test_a_low_window_says_how_high_it_has_to_be() -> None:
    shown = Shown(height=20)
    shown.screen.pin(ServedPages((LOCAL, PHONE), network=True, trouble=""))
    assert any(" 24 " in line for line in shown.lines())
    assert not any(FULL_BLOCK in line for line in shown.lines())


def opener(folder: Path) -> dict[str, str]:
    """Return a desktop whose browser writes the opened links to a file."""
    script = folder / "bin" / "xdg-open"
    script.parent.mkdir()
    noted = folder / "opened"
    script.write_text(f'#!/bin/sh\nprintf %s "$1" > "{noted}.part"\nmv "{noted}.part" "{noted}"\n', encoding="utf-8")
    script.chmod(0o755)
    return {"DISPLAY": ":9", "PATH": f"{script.parent}:{os.environ['PATH']}", "SSH_CONNECTION": "", "SSH_TTY": ""}


def test_run_at_a_terminal_pins_page_and_code(tmp_path: Path) -> None:
    pair(tmp_path / "var" / "teachers", tmp_path / "var" / "devices", "phone")
    words = ("run", "--phone", "--port", "0", "--page-port", "0", "--page-address", "127.0.0.1", "--no-record")
    desktop = opener(tmp_path)
    program = ProgramInTerminal(words, tmp_path, desktop, rows=40)
    opened = tmp_path / "opened"
    program.read_until(lambda sent: sent.count("0 RLAs |") > 2 and FULL_BLOCK in sent and opened.exists())
    code, sent = program.end(), program.sent
    terminal = Terminal()
    terminal.feed(sent)
    lines = [line.rstrip() for line in terminal.lines if line.strip()]
    assert code == 0
    assert sent.count("/pair?token=") > 2  # drawn again and again
    assert FULL_BLOCK in sent
    assert not any("pair?token=" in line or FULL_BLOCK in line for line in lines)  # and taken away at the end
    assert str(Question(None, None, math.inf, 0.0, ())) in lines
    assert lines[-1].endswith(" var/wall_following.knowledge")
    assert sum("RLAs |" in line for line in lines) == 0
    page = tmp_path / "var" / "devices" / "local" / "open.html"
    assert opened.read_text(encoding="utf-8") == page.as_uri()
    assert "url=http://127.0.0.1:" in page.read_text(encoding="utf-8")
    assert stat.S_IMODE(page.stat().st_mode) == 0o600


@pytest.mark.parametrize(
    ("environment", "there"),
    [
        ({}, False),
        ({"DISPLAY": ":0"}, True),
        ({"WAYLAND_DISPLAY": "wayland-0"}, True),
        ({"DISPLAY": ":10", "SSH_CONNECTION": "192.168.0.9 1 192.168.0.7 22"}, False),
    ],
)
def test_a_desktop_is_a_display_of_this_machine(environment: dict[str, str], *, there: bool) -> None:
    assert has_desktop(environment) is there
