"""Report of a search as one HTML file."""

from collections.abc import Sequence
from pathlib import Path

from kurt2rt.experiments.search.check import CheckResult
from kurt2rt.experiments.search.plan import SearchPlan
from kurt2rt.experiments.search.tables import verdict_text
from kurt2rt.experiments.study.figure import SavedFigure
from kurt2rt.experiments.study.html_report import spans, write_page
from kurt2rt.experiments.study.table import Table


def write_report(
    plan: SearchPlan,
    check: CheckResult,
    tables: Sequence[Table],
    pictures: Sequence[SavedFigure],
    command: str,
    path: Path,
) -> None:
    """Write tables, figure, space and provenance as an HTML page to `path`. Raises OSError.

    `command`: typed words, without those that belong to the machine alone.
    """
    search = plan.search
    space = Table(
        "Space",
        ("key", "low", "high", "logarithmic", "shipped"),
        tuple(
            (
                each.key,
                f"{each.low:g}",
                f"{each.high:g}",
                "yes" if each.log else "no",
                f"{plan.space.shipped[each.key]:g}",
            )
            for each in search.space
        ),
        words=2,
    )
    write_page(
        path,
        "kurt2rt.experiments.search",
        "report.html.j2",
        f"KURT2: search for settings of {search.task}",
        pictures,
        search=search,
        verdict=verdict_text(plan, check),
        tables=[*tables, space],
        search_seeds=spans(search.search.seeds.seeds),
        check_seeds=spans(plan.check.seeds.seeds),
        date=check.record.date,
        command=command,
        source=plan.made_of.source,
    )
