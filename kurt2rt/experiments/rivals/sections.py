"""Sections of a league's page: one for each way to teach, with the RLA system as shipped in each."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median

from kurt2rt.experiments.rivals.cells import heading, share_text
from kurt2rt.experiments.rivals.figures import draw_curves
from kurt2rt.experiments.rivals.leagues import TITLES, LeagueName, league_of
from kurt2rt.experiments.rivals.paired import compare_all
from kurt2rt.experiments.rivals.plan import League, Row
from kurt2rt.experiments.rivals.rival import SHIPPED
from kurt2rt.experiments.rivals.tables import all_tables, tuning_text
from kurt2rt.experiments.study.figure import SavedFigure
from kurt2rt.experiments.study.table import Table


@dataclass(frozen=True, slots=True)
class Section:
    """Rivals that are taught in one way."""

    name: LeagueName
    league: League
    tables: tuple[Table, ...]
    picture: SavedFigure

    @property
    def title(self) -> str:
        """Heading of the section."""
        return TITLES[self.name]

    @property
    def tuning(self) -> str:
        """Sentences about which rivals have settings that were searched."""
        return tuning_text(self.league)


def split_league(league: League) -> Iterator[tuple[LeagueName, League]]:
    """Yield each league that has rivals, with the rows of the RLA system as shipped; presses if there are no others.

    Raises NoLearnerError.
    """
    found = [name for name in TITLES if any(_is_of(row, name) for row in league.rows)]
    for name in found or [LeagueName.PRESSES]:
        rows = tuple(row for row in league.rows if row.entry.rival.name == SHIPPED or _is_of(row, name))
        yield name, replace(league, rows=rows)


def make_sections(league: League, folder: Path) -> tuple[Section, ...]:
    """Make the tables of each section, and draw its figure as a PNG to `folder`. Raises OSError."""
    return tuple(
        Section(name, part, tuple(all_tables(part)), draw_curves(part, folder / f"{_prefix(name)}rivals.png"))
        for name, part in split_league(league)
    )


def report_name(sections: tuple[Section, ...]) -> str:
    """Return the file name of the page with these sections."""
    prefix = _prefix(sections[0].name) if len(sections) == 1 else f"{LeagueName.ALL}-"
    return f"{prefix}report.html"


def overview_tables(league: League, sections: tuple[Section, ...]) -> list[Table]:
    """Return the table of all rows in short where a page has several sections, else none."""
    return [overview_table(league)] if len(sections) > 1 else []


def overview_table(league: League) -> Table:
    """Return the table of all leagues in short: what each learner cost its teacher, and what came of it."""
    rows = []
    for task in league.plan.tasks:
        shipped, others = league.of_task(task.name)
        compared = compare_all(shipped.outcomes, [row.outcomes for row in others])
        rows.append((*heading(shipped), *_short(shipped), ""))
        for row, each in zip(others, compared, strict=True):
            rows.append((*heading(row), *_short(row), f"{each.corrected:.3f}"))
    return Table(
        "All learners in short",
        (
            *("task", "learner", "taught by", "pass at the end", "presses", "teacher drives, s", "labels"),
            *("collisions while taught", "undo restores", "p by Holm"),
        ),
        tuple(rows),
        words=3,
        note="Robots that pass in every world of the exam, with a 95 % interval; medians of presses, seconds and "
        "labels, the sum of collisions. p: against the RLA system as shipped, robot by robot, McNemar's exact test, "
        "corrected for all rows of the task. The sections below have the rest.",
    )


def _short(row: Row) -> tuple[str, ...]:
    outcomes = row.outcomes
    return (
        TITLES[league_of(row.entry.rival)].removeprefix("Taught by "),
        share_text(row.passed(-1), len(row.judged)),
        f"{median(each.presses for each in outcomes):.0f}",
        f"{median(each.driven_s for each in outcomes):.0f}",
        f"{median(each.labels for each in outcomes):.0f}",
        str(sum(each.collisions for each in outcomes)),
        f"{sum(each.undo_restores for each in outcomes)} of {len(outcomes)}",
    )


def _is_of(row: Row, name: LeagueName) -> bool:
    return row.entry.rival.name != SHIPPED and league_of(row.entry.rival) is name


def _prefix(name: LeagueName) -> str:
    return "" if name is LeagueName.PRESSES else f"{name}-"
