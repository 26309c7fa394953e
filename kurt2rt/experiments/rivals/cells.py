"""Cells that several tables of a league have."""

from collections.abc import Callable, Iterable

from kurt2rt.experiments.lockstep.report import wilson_interval
from kurt2rt.experiments.rivals.plan import League, Row


def heading(row: Row) -> tuple[str, str]:
    """Return task and rival of a row."""
    return row.entry.task, row.entry.rival.title


def rows_of(league: League, cells: Callable[[Row], Iterable[str]]) -> tuple[tuple[str, ...], ...]:
    """Return the rows of a table with one for each row of the league: its heading and these cells."""
    return tuple((*heading(row), *cells(row)) for row in league.rows)


def share_text(count: int, of: int) -> str:
    """Return how many of some robots it was, with a 95 % interval."""
    if not of:
        return "none judged"
    return "{} of {} ({:.0%} to {:.0%})".format(count, of, *wilson_interval(count, of))
