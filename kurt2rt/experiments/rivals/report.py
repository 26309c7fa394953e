"""One HTML file of a league."""

from collections.abc import Sequence
from pathlib import Path

from kurt2rt.experiments.rivals.leagues import LeagueName
from kurt2rt.experiments.rivals.plan import LeaguePlan
from kurt2rt.experiments.rivals.sections import Section
from kurt2rt.experiments.study.html_report import spans, write_page
from kurt2rt.experiments.study.table import Table


def write_report(
    plan: LeaguePlan,
    sections: Sequence[Section],
    overview: Sequence[Table],
    not_judged: Sequence[str],
    command: str,
    path: Path,
) -> None:
    """Write the report of a league as an HTML page to `path`. Raises OSError.

    Args:
        plan: of the league.
        sections: with their tables and figures.
        overview: tables that stand before them.
        not_judged: reasons against judging the numbers.
        command: typed words that decide the numbers.
        path: of the page.
    """
    write_page(
        path,
        "kurt2rt.experiments.rivals",
        "report.html.j2",
        "KURT2: learners taught by the same teacher",
        [each.picture for each in sections],
        sections=sections,
        overview=overview,
        not_judged=not_judged,
        teachers=sorted({task.teaching.profile.name for task in plan.tasks}),
        seeds=spans(plan.seeds),
        presses=LeagueName.PRESSES,
        holds=LeagueName.HOLDS,
        command=command,
        source=plan.policy_jobs[0].made_of.source,
    )
