"""A terminal in which the addresses of the page and the status stay in place; all else is printed above them."""

from collections.abc import Iterator, Sequence

from rich.console import Console, Group
from rich.live import Live
from rich.text import Text

from kurt2rt.channel.security.pairing import OF_THIS_MACHINE
from kurt2rt.cli.qr_code import qr_code
from kurt2rt.teacher.page.served_pages import NO_PAGES, ServedPages

PAIR_A_PHONE = "for a phone: kurt2rt pair phone, in another terminal"
_WRONG = "yellow"


class LiveScreen:
    """Rewrites its last lines in place. Every call may wait for the terminal: it belongs to the printer's thread."""

    def __init__(self, console: Console, *, for_phones: bool) -> None:
        """`for_phones`: while no device is paired, say how to pair one."""
        self._console = console
        self._for_phones = for_phones
        self._live: Live | None = None
        self._pages = NO_PAGES
        self._doing, self._numbers = "", ""
        self._troubles: tuple[str, ...] = ()

    def print(self, text: str, style: str | None = None) -> None:
        """Print a line for good, above what stays in place."""
        self._console.print(text, style=style, markup=False, highlight=False)

    def pin(self, pages: ServedPages) -> None:
        """Show where the pages are; for the newest paired device as a code as well, if the window is high enough."""
        self._pages = pages
        self._refresh()

    def show(self, doing: str, numbers: str, troubles: Sequence[str]) -> None:
        """Show the status: what the robot does, its numbers, and what is wrong, each in lines of its own."""
        self._doing, self._numbers, self._troubles = doing, numbers, tuple(troubles)
        self._refresh()

    def close(self) -> None:
        """Take away what stays in place."""
        if self._live is not None:
            self._live.stop()
            self._live = None

    def _refresh(self) -> None:
        if self._live is None:
            self._live = Live(console=self._console, auto_refresh=False, transient=True, redirect_stdout=False)
            self._live.start()
            # It is hidden by Live, and a program that is ended at once would leave it so.
            self._console.show_cursor(True)
        self._live.update(self._lines(), refresh=True)

    def _lines(self) -> Group:
        phones = [each for each in self._pages.addresses if each.device not in OF_THIS_MACHINE]
        addresses = [*self._addresses()]
        if self._for_phones and self._pages.addresses and not phones:
            addresses.append(Text(PAIR_A_PHONE, style="dim"))
        if self._pages.trouble:
            addresses.append(Text(f"! {self._pages.trouble}", style=_WRONG))
        if not phones:
            return Group(*addresses, *self._status())
        code = qr_code(phones[0].link)
        width, height = self._console.size
        rows = [*code.plain.split("\n"), *self._console.render_lines(Group(*addresses)), *self._short_status()]
        if len(rows) < height and len(code) <= width * len(code.plain.split("\n")):
            return Group(code, *addresses, *self._short_status())
        hint = f"the code to scan needs a window of {len(rows) + 1} lines"
        return Group(*addresses, Text(hint, style="dim"), *self._status())

    def _addresses(self) -> Iterator[Text]:
        names = ["page" if each.device in OF_THIS_MACHINE else each.device for each in self._pages.addresses]
        for name, each in zip(names, self._pages.addresses, strict=True):
            yield Text.assemble((name.ljust(max(map(len, names)) + 2), "bold"), (each.link, "cyan"), overflow="fold")

    def _status(self) -> Iterator[Text]:
        if self._doing:
            yield Text(self._doing, style="bold")
            yield Text(self._numbers, style="dim")
        for each in self._troubles:
            yield Text(f"! {each}", style=_WRONG)

    def _short_status(self) -> tuple[Text, Text]:
        """Two rows, whatever there is to say: the code must not come and go with it."""
        wrong = f"! {'; '.join(self._troubles)}" if self._troubles else ""
        rows = ((self._doing, "bold"), (wrong or self._numbers, _WRONG if wrong else "dim"))
        doing, more = (Text(text, style=style, no_wrap=True, overflow="ellipsis") for text, style in rows)
        return doing, more
