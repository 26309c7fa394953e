"""Table for terminal and report, from rows and columns; targets of a study, and whether its robots are judged."""

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from operator import attrgetter
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from rich.console import Group, RenderableType
from rich.text import Text

from kurt2rt.experiments.study.intervals import Rate, quartiles, wilson_interval
from kurt2rt.platform.text_table import TextTable

RowT = TypeVar("RowT")
Column = tuple[str, Callable[[Any], object]]
"""Heading of a column, and the function from a row to what its cell shows."""


@dataclass(frozen=True, slots=True)
class Table:
    """Table of a study, of texts, for terminal and report."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    words: int = 1
    """So many columns from the left hold words, the others numbers."""
    note: str = ""
    """Explanation below the table."""


@dataclass(frozen=True, slots=True)
class Told:
    """Results that a study shows at its end: on a terminal what fits a screen, in a pipe or as JSON all tables."""

    tables: Sequence[Table]
    sentence: str = ""
    """Result in one sentence, which opens the report, too."""
    about: Sequence[str] = ()
    """Texts for the report alone that say what was done; between backticks stands what is typed."""
    short: Table | None = None
    """Table of what was asked and what came, with the sentence alone on a terminal; None: it shows all tables."""
    not_judged: Sequence[str] = ()
    """Reasons against judging by its targets."""
    files: Mapping[str, Path] = field(default_factory=dict)
    """Files that it leaves, by what they are, such as report."""
    lines: Sequence[str] = ()
    """Commands to copy, below the tables."""
    data: Mapping[str, object] = field(default_factory=dict)
    """Numbers for JSON besides the tables."""


def table_of(
    title: str, rows: Iterable[RowT], *columns: tuple[str, Callable[[RowT], object]], words: int = 1, note: str = ""
) -> Table:
    """Return a table with a row for each of `rows`; the fields of `Table` have their other parts."""
    cells = tuple(tuple(str(of(row)) for _, of in columns) for row in rows)
    return Table(title, tuple(heading for heading, _ in columns), cells, words, note)


def settings_table(title: str, settings: Mapping[str, Mapping[str, Any]]) -> Table:
    """Return a row for each setting that has a value, by its path, and a column for each of `settings` by its key."""
    columns = {heading: dict(_leaves(each, "")) for heading, each in settings.items()}
    names = dict.fromkeys(name for each in columns.values() for name, text in each.items() if text)
    rows = tuple((name, *(each.get(name, "") for each in columns.values())) for name in names)
    return Table(title, ("setting", *columns), rows, words=1 + len(columns))


def _leaves(value: Any, name: str) -> Iterator[tuple[str, str]]:
    if isinstance(value, Mapping):
        for key, each in value.items():
            yield from _leaves(each, f"{name}.{key}" if name else key)
    elif isinstance(value, list) and any(isinstance(each, Mapping) for each in value):
        for number, each in enumerate(value):
            yield from _leaves(each, f"{name}.{number}")
    elif isinstance(value, list):
        yield name, ", ".join(map(str, value))
    else:
        yield name, f"{value:g}" if isinstance(value, float) else str(value)


def as_rich(table: Table) -> RenderableType:
    """Return the table for the terminal, in plain text: a missed target shows as a word, not as a color."""
    shown = TextTable(title=table.title)
    for place, heading in enumerate(table.columns):
        shown.add_column(heading, number=place >= table.words, whole=place < table.words <= 2)
    for row in table.rows:
        shown.add_row(*row)
    return Group(shown, *([Text(table.note)] if table.note else ()))


def middle(heading: str, path: str, form: str = "g") -> Column:
    """Return the column of the median over the rows of a group; `path`: attributes with dots, such as lesson.asks."""
    of = attrgetter(path)
    return heading, lambda group: f"{median(of(row) for row in group.rows):{form}}"


def quarters(path: str, form: str = "g", heading: str = "quartiles") -> Column:
    """Return the column of the lower and the upper quartile over the rows of a group, next to `middle`."""
    of = attrgetter(path)
    return heading, lambda group: to_text(quartiles([of(row) for row in group.rows])[::2], form)


def most(heading: str, path: str) -> Column:
    """Return the column of the largest value over the rows of a group."""
    of = attrgetter(path)
    return heading, lambda group: f"{max(of(row) for row in group.rows):g}"


def total(heading: str, path: str) -> Column:
    """Return the column of the sum over the rows of a group; True counts as 1."""
    of = attrgetter(path)
    return heading, lambda group: sum(of(row) for row in group.rows)


def share(heading: str, path: str) -> Column:
    """Return the column of the number of rows of a group for which an attribute is true: `18 of 20`."""
    of = attrgetter(path)
    return heading, lambda group: of_text(sum(map(of, group.rows)), len(group.rows))


def rate_columns(heading: str, rate: Callable[[Any], Rate], form: str = ".2f") -> tuple[Column, Column]:
    """Return the columns of a rate and of its 95 % interval."""
    return ((heading, lambda row: f"{rate(row).value:{form}}"), ("95 %", lambda row: to_text(rate(row)[1:], form)))


def median(values: Iterable[float]) -> float:
    """Return the median of values, such as counts or seconds; of two middle values their mean."""
    return quartiles(list(values))[1]


def of_text(count: int, whole: int, *, interval: bool = False) -> str:
    """Return `18 of 20` for `count` of `whole`; with an interval, `none judged` if `whole` is 0.

    `interval`: with the 95 % interval of the share.
    """
    if not whole and interval:
        return "none judged"
    text = f"{count} of {whole}"
    return f"{text} ({share_text(count, whole)})" if interval else text


def share_text(count: int, whole: int) -> str:
    """Return the 95 % interval of a share, such as `44% to 100%`; empty of none."""
    return to_text(wilson_interval(count, whole), ".0%") if whole else ""


def to_text(ends: Iterable[float], form: str) -> str:
    """Return `1.5 to 2.5`: the ends of an interval, each in the format `form`."""
    low, high = ends
    return f"{low:{form}} to {high:{form}}"


def rate_text(rate: Rate, form: str = ".2f") -> str:
    """Return `2.0 (1.5 to 2.5)`: a rate and its interval, each in the format `form`."""
    return f"{rate.value:{form}} ({to_text(rate[1:], form)})"


def collisions_text(collisions: int) -> str:
    """Return a number of collisions in words, such as `2 collisions`."""
    return f"{collisions} collision{'' if collisions == 1 else 's'}"


ROBOTS = 20
"""Number of robots for which targets are defined."""
CHOSEN_ON = (range(80), range(3000, 4000))
"""Seeds that settings were searched on; results of such robots are not judged."""


def reasons_against_judging(seeds: Sequence[int]) -> Iterator[str]:
    """Yield the reasons against judging; none for enough robots with new seeds."""
    robots = len(seeds)
    if robots < ROBOTS:
        yield f"{robots} robot{'' if robots == 1 else 's'} only; the numbers are asked of {ROBOTS}."
    for chosen in CHOSEN_ON:
        if known := sum(seed in chosen for seed in seeds):
            yield (
                f"{known} of the seeds are among {chosen[0]} to {chosen[-1]}, on which settings were chosen; "
                "give others."
            )


class Verdict(NamedTuple):
    """Target of a study: its name, the number asked for, the number that came, and whether it was met.

    Tables show it as met, MISSED or not judged; targets were written down before the runs.
    """

    what: str
    asked: str
    came: str
    met: bool
    judged: bool = True
    """False: there is nothing to judge by."""

    @property
    def result(self) -> str:
        """Result in a word; a miss is in capitals, so that it is seen without color."""
        return ("met" if self.met else "MISSED") if self.judged else "not judged"


def needed_of(share: float, robots: int) -> int:
    """Return the least number of robots that reaches a share, 0 to 1: of 20 robots 0.9 asks for 18.

    Rounding errors of the product do not count.
    """
    return math.ceil(share * robots - 1e-9)


def targets_table(
    verdicts: Iterable[tuple[tuple[str, ...], Verdict]],
    not_judged_because: Sequence[str],
    *,
    title: str = "What was asked",
    headings: tuple[str, ...] = (),
    note_without_targets: str = "",
) -> Table:
    """Return a row for each verdict; with reasons against judging, all results are `not judged`.

    `verdicts`: each with the cells of the columns `headings`, which come first.
    """
    found = list(verdicts)
    met = sum(verdict.met for _, verdict in found)
    note = f"{met} of {len(found)} numbers asked for are met." if found else note_without_targets
    shown = [(cells, each._replace(judged=each.judged and not not_judged_because)) for cells, each in found]
    return Table(
        title,
        (*headings, "what", "asked", "came", "verdict"),
        tuple((*cells, each.what, each.asked, each.came, each.result) for cells, each in shown),
        words=len(headings) + 4,
        note=" ".join(["Not judged.", *not_judged_because]) if not_judged_because else note,
    )


def brief(targets: Table) -> Table:
    """Return targets for a terminal: after the first column, cells end before their first comma or bracket."""
    rows = ((what, *(re.split(r"[,;] | \(", cell)[0] for cell in others)) for what, *others in targets.rows)
    return replace(targets, rows=tuple(rows))
