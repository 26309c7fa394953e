"""Claims about the RLA system that a league may refute."""

from collections.abc import Callable, Sequence
from statistics import median

from kurt2rt.experiments.rivals.cells import share_text
from kurt2rt.experiments.rivals.plan import League, Row
from kurt2rt.experiments.study.table import Table

_CLAIMED = 0.9
"""Part of the success of the RLA system that refutes the claim about success."""
_TIMES = 3.0
"""Factor of the seconds in charge below which the claim about seconds is refuted."""
_NOT_JUDGED = "not judged"
"""Verdict where no robot with the RLA system passes: every learner reaches a part of nothing."""


Cells = tuple[str, ...]


def claim_table(league: League) -> Table:
    """Return whether a rival comes close to the RLA system as shipped, task by task, at the end of the lessons."""
    return Table(
        f"Claim: no other learner reaches {_CLAIMED:g} of the success of the RLA system",
        ("task", "RLA system", "best other", "passes", "of the RLA system's", "claim"),
        _rows(league, _success_cells),
        words=1,
        note="At the end of the lessons, with the same teacher's effort for all. The best of many rows is chosen after "
        "the fact, which favours it. Other rows of the RLA system do not count, nor do agents: a judge "
        "rewards them ten times a second, for a robot life of their own.",
    )


def hands_table(league: League) -> Table:
    """Return the seconds in charge of the RLA system as shipped, and of the rival that needs fewest, task by task."""
    return Table(
        f"Claim: a rival that is driven by hand needs {_TIMES:g} times the seconds in charge",
        ("task", "RLA system, s", "fewest", "s", "times the RLA system's", "claim"),
        _rows(league, _hands_cells),
        words=1,
        note=f"Among rivals with a teacher in charge that reach {_CLAIMED:g} of the success of the RLA system as "
        "shipped. Seconds in which the teacher drives, the median robot's. Presses are in the table of the effort.",
    )


def _rows(league: League, cells: Callable[[Row, Sequence[Row]], Cells | None]) -> tuple[Cells, ...]:
    """Return a row for each task in which robots of the RLA system are judged, unless `cells` of its rows are None."""
    rows = []
    for task in league.plan.tasks:
        shipped, others = league.of_task(task.name)
        rivals = [row for row in others if row.judged and _has_its_effort(row)]
        told = cells(shipped, rivals) if shipped.judged else None
        if told is not None:
            rows.append((task.name, *told))
    return tuple(rows)


def _has_its_effort(row: Row) -> bool:
    """Return whether a row is of another learner, with the same teacher's effort."""
    return not (row.entry.rival.is_rla_system or row.entry.rival.is_agent)


def _success_cells(shipped: Row, rivals: Sequence[Row]) -> Cells | None:
    best = max(rivals, key=_share_at_end, default=None)
    if best is None:
        return None
    ours, theirs = _share_at_end(shipped), _share_at_end(best)
    return (
        share_text(shipped.passed(-1), len(shipped.judged)),
        best.entry.rival.title,
        share_text(best.passed(-1), len(best.judged)),
        f"{theirs / ours:.2f}" if ours else "-",
        _NOT_JUDGED if not ours else "refuted" if theirs >= _CLAIMED * ours else "stands",
    )


def _hands_cells(shipped: Row, rivals: Sequence[Row]) -> Cells:
    ours_s = _seconds(shipped)
    if not _share_at_end(shipped):
        return f"{ours_s:.0f}", "-", "-", "-", _NOT_JUDGED
    enough = _CLAIMED * _share_at_end(shipped)
    close = (row for row in rivals if row.entry.rival.is_held and _share_at_end(row) >= enough)
    best = min(close, key=_seconds, default=None)
    if best is None:
        return f"{ours_s:.0f}", "none", "-", "-", "stands"
    theirs_s = _seconds(best)
    times = f"{theirs_s / ours_s:.1f}" if ours_s else "-"
    verdict = "refuted" if theirs_s < _TIMES * ours_s else "stands"
    return f"{ours_s:.0f}", best.entry.rival.title, f"{theirs_s:.0f}", times, verdict


def _share_at_end(row: Row) -> float:
    return row.passed(-1) / len(row.judged)


def _seconds(row: Row) -> float:
    return median(each.driven_s for each in row.outcomes)
