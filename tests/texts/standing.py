"""Listing of the texts of `kurt2rt.standing_text`."""

from collections.abc import Callable, Iterator

from kurt2rt.standing import Standing, StandReason
from kurt2rt.standing_text import GO_IN_TERMINAL, GO_ON_PAGE, headline_of, in_short


def on_page() -> Iterator[tuple[str, str]]:
    """Yield the page's headline of each standing."""
    return _each(lambda standing: headline_of(standing, GO_ON_PAGE))


def in_terminal() -> Iterator[tuple[str, str]]:
    """Yield the terminal's headline of each standing."""
    return _each(lambda standing: headline_of(standing, GO_IN_TERMINAL))


def in_log() -> Iterator[tuple[str, str]]:
    """Yield the short form of each standing."""
    return _each(in_short)


def _each(text: Callable[[Standing], str]) -> Iterator[tuple[str, str]]:
    for reason in StandReason:
        says = "Ann said stop" if reason is StandReason.STOPPED else ""
        yield reason, text(Standing(reason, stall_s=1.25, says=says))
        yield f"{reason}, until Go", text(Standing(reason, needs_go=True, stall_s=1.25, says=says))
        yield f"{reason}, asks", text(Standing(reason, asks=True, stall_s=1.25, says=says))
