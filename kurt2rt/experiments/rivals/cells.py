"""Cells that several tables of a league have."""

from kurt2rt.experiments.lockstep.report import wilson_interval
from kurt2rt.experiments.rivals.plan import Row


def heading(row: Row) -> tuple[str, str]:
    """Return task and rival of a row."""
    return row.entry.task, row.entry.rival.title


def share_text(count: int, of: int) -> str:
    """Return how many of some robots it was, with a 95 % interval."""
    if not of:
        return "none judged"
    return "{} of {} ({:.0%} to {:.0%})".format(count, of, *wilson_interval(count, of))
