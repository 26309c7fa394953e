"""Output of the robot program on a plain stream and in a service's log."""

import io
from dataclasses import replace
from pathlib import Path

from rich.console import Console

from kurt2rt.cli.terminal_screen import TerminalScreen
from kurt2rt.teacher.page.served_pages import ServedPages, to_line
from tests.channel.channel_fixture import ChannelFixture
from tests.cli.test_live_screen import LOCAL, PHONE
from tests.cli.test_status_line import status_of
from tests.service.health.reports import A_BUS


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


def test_page_line_tells_each_address_once() -> None:
    shown = Shown()
    shown.screen.page_line(to_line(ServedPages((LOCAL,), network=False, trouble="")))
    assert shown.lines()[1:] == [LOCAL.link]
    shown.screen.page_line(to_line(ServedPages((LOCAL, PHONE), network=True, trouble="no keys")))
    assert shown.lines()[1:] == [PHONE.link, "no keys"]
    shown.screen.page_line(to_line(ServedPages((LOCAL, PHONE), network=True, trouble="no keys")))
    assert shown.lines() == []
    assert shown.screen.links == (LOCAL.link, PHONE.link)


def test_show_in_a_log_prints_changes_other_than_numbers() -> None:
    shown, status = Shown(as_service=True), status_of(ChannelFixture())
    shown.screen.show_status(status, A_BUS, "")
    assert shown.lines() == []
    for errors in (130, 131):
        shown.screen.show_status(status, replace(A_BUS, controller_trouble=f"{errors} errors"), "")
    assert len(shown.lines()) == 1
    shown.screen.show_status(status, A_BUS, "no simulator")
    assert len(shown.lines()) == 1
    shown.screen.show_status(status, A_BUS, "")
    assert len(shown.lines()) == 1
