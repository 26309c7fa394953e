"""Output of the robot program on a plain stream and in a service's log."""

import io
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from kurt2rt.cli.terminal_screen import TerminalScreen
from kurt2rt.service.post_tick import ProgramStatus
from kurt2rt.teacher.page.served_pages import PageAddress, ServedPages, to_line
from tests.channel.channel_fixture import ChannelFixture
from tests.cli.test_status_line import PASSIVE, WELL

LOCAL = PageAddress("local", "http://127.0.0.1:8642/pair?token=" + 32 * "a")
PHONE = PageAddress("phone", "http://192.168.100.100:8642/pair?token=" + 32 * "b")


class Shown:
    """A screen whose console is a text."""

    def __init__(self, *, as_service: bool = False) -> None:
        self._text = io.StringIO()
        self.screen = TerminalScreen(Console(file=self._text, width=80), Path(), as_service=as_service)

    def lines(self) -> list[str]:
        """Return the lines since the last call."""
        lines = self._text.getvalue().splitlines()
        self._text.seek(0)
        self._text.truncate()
        return lines


@pytest.fixture(scope="module")
def status() -> ProgramStatus:
    desk = ChannelFixture()
    return ProgramStatus(desk.record, desk.runtime, 0, None, "")


def test_page_line_tells_each_address_once() -> None:
    shown = Shown()
    shown.screen.page_line(to_line(ServedPages((LOCAL,), network=False, trouble="")))
    assert shown.lines()[1:] == [LOCAL.link]
    shown.screen.page_line(to_line(ServedPages((LOCAL, PHONE), network=True, trouble="no keys")))
    assert shown.lines()[1:] == [PHONE.link, "no keys"]
    shown.screen.page_line(to_line(ServedPages((LOCAL, PHONE), network=True, trouble="no keys")))
    assert shown.lines() == []
    assert shown.screen.links == (LOCAL.link, PHONE.link)


def test_show_in_a_log_prints_changes_other_than_numbers(status: ProgramStatus) -> None:
    shown = Shown(as_service=True)
    shown.screen.show_status(status, WELL, "")
    assert shown.lines() == []
    for errors in (130, 131):
        shown.screen.show_status(status, replace(PASSIVE, controller_trouble=f"{errors} errors"), "")
    assert len(shown.lines()) == 1
    shown.screen.show_status(status, WELL, "no simulator")
    assert len(shown.lines()) == 1
    shown.screen.show_status(status, WELL, "")
    assert len(shown.lines()) == 1
