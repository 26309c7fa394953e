"""Terminal whose last lines hold the page's addresses and the status; other lines are printed above them."""

from collections.abc import Iterator, Sequence

from rich.console import Console, Group
from rich.live import Live
from rich.text import Text

from kurt2rt.channel.security.pairing import OF_THIS_MACHINE
from kurt2rt.cli.qr_code import NO_CODE, qr_code, shows_codes
from kurt2rt.teacher.page.served_pages import NO_PAGES, PageAddress, ServedPages

PAIR_A_PHONE = "for a phone: kurt2rt pair phone, in another terminal"
_WRONG = "yellow"


class LiveScreen:
    """Lines at the bottom of the terminal of `kurt2rt run`, rewritten in place: addresses and status.

    Each call may block: call it from the printer's thread only.
    """

    def __init__(self, console: Console, *, for_phones: bool) -> None:
        """Write to a console; `for_phones`: show how to pair a device while none is paired."""
        self._console = console
        self._for_phones = for_phones
        self._live: Live | None = None
        self._pages = NO_PAGES
        self._doing, self._numbers = "", ""
        self._troubles: tuple[str, ...] = ()

    def pin(self, pages: ServedPages) -> None:
        """Show the pages' addresses, and the newest paired device's as a code if the window is high enough."""
        self._pages = pages
        self._refresh()

    def show(self, doing: str, numbers: str, troubles: Sequence[str]) -> None:
        """Show the status: activity, numbers and faults, each in its own lines."""
        self._doing, self._numbers, self._troubles = doing, numbers, tuple(troubles)
        self._refresh()

    def close(self) -> None:
        """Remove the lines in place, and leave the terminal as it was."""
        if self._live is not None:
            self._live.stop()
            self._live = None

    def _refresh(self) -> None:
        if self._live is None:
            self._live = Live(console=self._console, auto_refresh=False, transient=True, redirect_stdout=False)
            self._live.start()
            # Live hides the cursor, and a program that is killed would leave it hidden.
            self._console.show_cursor(True)
        self._live.update(self._lines(), refresh=True)

    def _lines(self) -> Group:
        phones = [each for each in self._pages.addresses if each.device not in OF_THIS_MACHINE]
        every = [*self._addresses(self._pages.addresses)]
        if self._for_phones and self._pages.addresses and not phones and not self._pages.network:
            every.append(Text(PAIR_A_PHONE, style="dim"))
        if phones and not shows_codes(self._console):
            every.append(Text(NO_CODE, style="dim"))
        if not phones or not shows_codes(self._console):
            return Group(*every, *self._status())
        code = qr_code(phones[0].link)
        width, height = self._console.size
        # In a low window the code is worth more than the further addresses of a device.
        likeliest = {each.device: each for each in reversed(self._pages.addresses)}
        shown = [each for each in self._pages.addresses if likeliest[each.device] is each]
        for addresses in (every, [*self._addresses(shown)]):
            rows = [*code.plain.split("\n"), *self._console.render_lines(Group(*addresses)), *self._short_status()]
            if len(rows) < height and len(code) <= width * len(code.plain.split("\n")):
                return Group(code, *addresses, *self._short_status())
        hint = f"the code to scan needs a window of {len(rows) + 1} lines"
        return Group(*every, Text(hint, style="dim"), *self._status())

    def _addresses(self, addresses: Sequence[PageAddress]) -> Iterator[Text]:
        names = ["page" if each.device in OF_THIS_MACHINE else each.device for each in addresses]
        for name, each in zip(names, addresses, strict=True):
            yield Text.assemble((name.ljust(max(map(len, names)) + 2), "bold"), (each.link, "cyan"), overflow="fold")
        if self._pages.trouble:
            yield Text(f"! {self._pages.trouble}", style=_WRONG)

    def _status(self) -> Iterator[Text]:
        if self._doing:
            yield Text(self._doing, style="bold")
            yield Text(self._numbers, style="dim")
        for each in self._troubles:
            yield Text(f"! {each}", style=_WRONG)

    def _short_status(self) -> tuple[Text, Text]:
        """Return the status in two rows always, so that the code keeps its place."""
        wrong = f"! {'; '.join(self._troubles)}" if self._troubles else ""
        rows = ((self._doing, "bold"), (wrong or self._numbers, _WRONG if wrong else "dim"))
        doing, more = (Text(text, style=style, no_wrap=True, overflow="ellipsis") for text, style in rows)
        return doing, more
