"""View of one RLA: condition, action and expectation (paper, III.A), for `knowledge show --rla`."""

from typing import Any

from rich.console import Group, RenderableType
from rich.text import Text

from kurt2rt.core.expectations.expectations import is_valid_for
from kurt2rt.core.perception.definition import AVERAGED
from kurt2rt.core.rla.rla import BASIC, Rla
from kurt2rt.core.rla.statistics import Expectation, Statistics, follow_ups
from kurt2rt.knowledge.journal.fold import read_content
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.knowledge.show.knowledge import TICK_S
from kurt2rt.knowledge.show.table_cells import printable
from kurt2rt.platform.text_table import TextTable


def render_rla(journal: Journal, rla_id: int, limit: int | None = None) -> RenderableType:
    """Return one RLA and what followed it, features with the largest change first, at most `limit` of them.

    Raises KnowledgeError if no such RLA lives.
    """
    rla, names, statistics, expectation = _read(journal, rla_id)
    origin = rla.origin
    uses = statistics.uses.get(rla_id, 0)
    parts: list[RenderableType] = [
        printable(
            f"{rla.title}: {rla.action}, taught by {origin.teacher} in phase {origin.phase.value}, used {uses} times"
        )
    ]
    shares = follow_ups(statistics).get(rla_id, {})
    if shares:
        parts.append(Text("followed by " + ", ".join(f"{each} ({share:.0f} %)" for each, share in shares.items())))
    if expectation is None:
        parts.append(Text("Nothing is expected yet: it was never seen to end with another RLA taking over."))
    else:
        seconds = f"{expectation.ticks * TICK_S:.2f} s"
        parts.append(Text(f"expected, of {expectation.count} ends seen, {seconds} after it began:"))
    parts.append(_features(rla, names, expectation, limit))
    return Group(*parts)


def expectation_data(journal: Journal, rla_id: int) -> dict[str, Any] | None:
    """Return the number of observed ends, the mean time in s, mean and spread of an RLA's end, for JSON.

    Returns None before its first end. Raises KnowledgeError if no such RLA lives.
    """
    _, names, _, expectation = _read(journal, rla_id)
    if expectation is None:
        return None
    return {
        "ends_seen": expectation.count,
        "after_s": expectation.ticks * TICK_S,
        "mean": dict(zip(names, expectation.mean.tolist(), strict=True)),
        "spread": dict(zip(names, expectation.spread.tolist(), strict=True)),
    }


def _read(journal: Journal, rla_id: int) -> tuple[Rla, tuple[str, ...], Statistics, Expectation | None]:
    """Return an RLA, the names of its features, the statistics, and its expectation; KnowledgeError if it is gone."""
    _, system, statistics = read_content(journal)
    rla = system.get(rla_id)
    if rla is None:
        raise KnowledgeError(KnowledgeCode.NO_SUCH_RLA, where=journal.path, rla_id=rla_id)
    binding = journal.binding
    names = binding.feature_names if rla.level == BASIC else binding.levels[rla.level].feature_names
    known = statistics.expectations.get(rla_id)
    return (
        rla,
        names,
        statistics,
        known if known is not None and is_valid_for(system, rla_id, known, rla.level) else None,
    )


def _features(rla: Rla, names: tuple[str, ...], expectation: Expectation | None, limit: int | None) -> RenderableType:
    mean = None if expectation is None else expectation.mean.tolist()
    spread = None if expectation is None else expectation.spread.tolist()
    # Averages over seconds hardly show what one RLA changed: they come last.
    farthest = rla.condition if mean is None else [then - now for then, now in zip(mean, rla.condition, strict=True)]
    order = sorted(range(len(names)), key=lambda place: (names[place].endswith(AVERAGED), -abs(farthest[place])))
    table = TextTable()
    for heading in ("feature", "condition", *(("expected", "spread") if mean is not None else ())):
        table.add_column(heading, number=heading != "feature")
    for place in order[:limit]:
        cells = [_number(rla.condition[place])]
        if mean is not None and spread is not None:
            cells += [_number(mean[place]), f"±{_number(spread[place])}"]
        table.add_row(printable(names[place]), *cells)
    hidden = len(names) - table.row_count
    return Group(table, Text(f"and {hidden} more features")) if hidden else table


def _number(value: float) -> str:
    """Format a count as a whole number, metres and fractions with two decimals."""
    return f"{value:.0f}" if abs(value) >= 10 else f"{value:.2f}".rstrip("0").rstrip(".")
