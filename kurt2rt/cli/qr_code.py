"""A link as a QR code in a terminal."""

import io

import segno
from rich.text import Text

_QUIET_ZONE = 2
"""Modules of light around it. The standard wants 4, phones read it with 2, and a window of 24 lines has no more."""


def qr_code(link: str) -> Text:
    """Return the code, two modules a character high: 19 lines of 37 characters for a link of up to 78 letters."""
    drawn = io.StringIO()
    segno.make(link, error="l", micro=False, boost_error=False).terminal(drawn, border=_QUIET_ZONE, compact=True)
    # White on black whatever the terminal's colours are: cameras dislike negatives.
    return Text(drawn.getvalue().rstrip("\n"), style="bright_white on black", no_wrap=True)
