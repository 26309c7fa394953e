"""One HTML file of a league."""

from collections.abc import Sequence
from pathlib import Path

from kurt2rt.experiments.rivals.leagues import LeagueName
from kurt2rt.experiments.rivals.plan import League
from kurt2rt.experiments.rivals.sections import Section, overview_table
from kurt2rt.experiments.rivals.tables import tuning_text
from kurt2rt.experiments.study.html_report import spans, write_page
from kurt2rt.experiments.study.table import Table


def write_report(
    league: League, sections: Sequence[Section], not_judged: Sequence[str], command: str, path: Path
) -> None:
    """Write the report of a league as an HTML page to `path`. Raises OSError.

    Args:
        league: all rows.
        sections: of it, with their tables and figures; a page of several begins with a table of all rows in short.
        not_judged: reasons against judging the numbers.
        command: typed words that decide the numbers.
        path: of the page.
    """
    plan = league.plan
    write_page(
        path,
        "kurt2rt.experiments.rivals",
        "report.html.j2",
        "KURT2: learners taught by the same teacher",
        [each.picture for each in sections],
        sections=sections,
        overview=overview_tables(league, sections),
        tuning=[tuning_text(each.league) for each in sections],
        not_judged=not_judged,
        teachers=sorted({task.teaching.profile.name for task in plan.tasks}),
        seeds=spans(plan.seeds),
        presses=LeagueName.PRESSES,
        holds=LeagueName.HOLDS,
        command=command,
        source=plan.policy_jobs[0].made_of.source,
    )


def overview_tables(league: League, sections: Sequence[Section]) -> list[Table]:
    """Return the table of all rows in short where a page has several sections."""
    return [overview_table(league)] if len(sections) > 1 else []
