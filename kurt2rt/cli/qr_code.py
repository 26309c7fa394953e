"""A link as a QR code in a terminal."""

import io

import segno
from rich.console import Console
from rich.text import Text

_QUIET_ZONE = 2
"""Width of the light border in modules. The standard asks for 4; phones read 2, and 24 lines have no room for more."""

NO_CODE = "this terminal's encoding has no letters for a code to scan: open the address, or set a UTF-8 locale"


def shows_codes(console: Console) -> bool:
    """Return whether the encoding of a console has the blocks of a code."""
    try:
        "█▀▄".encode(console.encoding)
    except UnicodeEncodeError:
        return False
    return True


def print_code(console: Console, link: str) -> None:
    """Print the QR code of a link, or why the console cannot show it."""
    console.print(qr_code(link) if shows_codes(console) else NO_CODE, soft_wrap=True)


def qr_code(link: str) -> Text:
    """Return the QR code of a link as text, two modules a character high.

    It has 19 lines of 37 characters for a link of up to 78 letters.
    """
    drawn = io.StringIO()
    segno.make(link, error="l", micro=False, boost_error=False).terminal(drawn, border=_QUIET_ZONE, compact=True)
    # White on black in any colour scheme, because some cameras do not read an inverted code.
    return Text(drawn.getvalue().rstrip("\n"), style="bright_white on black", no_wrap=True)
