"""Listings of the texts of `kurt2rt.teacher.page.texts` and of static/texts.js."""

import re
from collections.abc import Iterator

from kurt2rt.teacher.page.app import STATIC
from kurt2rt.teacher.page.texts import PageNotice, text_of

SAMPLES = {"place": "127.0.0.1:5683", "most_mb": 64, "name": "a.zip", "size": 70_000_000, "most": 64_000_000}


def notices() -> Iterator[tuple[str, str]]:
    """Yield the text of each notice of the page's server."""
    for notice in PageNotice:
        yield notice, text_of(notice, **{name: SAMPLES[name] for name in notice.fields})


def sentences() -> Iterator[tuple[str, str]]:
    """Yield the page's own sentences, as static/texts.js has them."""
    script = (STATIC / "texts.js").read_text(encoding="utf-8")
    yield from re.findall(r'^  (\w+): "(.*)",$', script, re.MULTILINE)
