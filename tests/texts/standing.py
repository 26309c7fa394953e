"""Listing of the texts of `kurt2rt.core.decision.standing`."""

from collections.abc import Callable, Iterator

from kurt2rt.core.decision.decision import StandReason
from kurt2rt.core.decision.standing import (
    GO_IN_TERMINAL,
    GO_ON_PAGE,
    ActiveStop,
    Standing,
    StopReason,
    short_text,
    standing_headline,
    stop_text,
)


def on_page() -> Iterator[tuple[str, str]]:
    """Yield the page's headline of each standing."""
    return _each(lambda standing: standing_headline(standing, GO_ON_PAGE))


def in_terminal() -> Iterator[tuple[str, str]]:
    """Yield the terminal's headline of each standing."""
    return _each(lambda standing: standing_headline(standing, GO_IN_TERMINAL))


def in_log() -> Iterator[tuple[str, str]]:
    """Yield the short form of each standing."""
    return _each(short_text)


def _each(text: Callable[[Standing], str]) -> Iterator[tuple[str, str]]:
    for reason in StandReason:
        stop = ActiveStop(StopReason.SAID_STOP, "Ann") if reason is StandReason.STOPPED else None
        yield reason, text(Standing(reason, stall_s=1.25, stop=stop))
        yield f"{reason}, until Go", text(Standing(reason, needs_resume=True, stall_s=1.25, stop=stop))
        yield f"{reason}, asks", text(Standing(reason, asks=True, stall_s=1.25, stop=stop))
    sensor = ActiveStop(StopReason.SENSOR_BROKEN, "front left edge (s15)")
    yield f"{StandReason.STOPPED}, {sensor.reason}", text(Standing(StandReason.STOPPED, True, stop=sensor))


def stops() -> Iterator[tuple[str, str]]:
    """Yield the sentence of each stop, the same on every surface."""
    names = {
        StopReason.SESSION_OVER: "morning",
        StopReason.BEHAVIOUR_OVER: "spin_left",
        StopReason.SENSOR_BROKEN: "front left edge (s15)",
        StopReason.FALLS_BEHIND: "3",
        StopReason.GUARD: "wheels disobey",
    }
    for reason in StopReason:
        yield reason, stop_text(ActiveStop(reason, names.get(reason, "Ann")))
