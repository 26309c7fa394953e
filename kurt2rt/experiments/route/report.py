"""One HTML file that holds everything: tables, pictures of the drives, and how it was made."""

from collections.abc import Sequence
from pathlib import Path

from kurt2rt.experiments.route.summary import RouteStudy
from kurt2rt.experiments.route.tables import all_tables
from kurt2rt.experiments.study.eligibility import reasons_against_judging
from kurt2rt.experiments.study.figure import SavedFigure
from kurt2rt.experiments.study.html_report import spans, write_page
from kurt2rt.experiments.study.provenance import source_hash

_TITLE = "KURT2: routes that its mid level was taught"


def write_report(study: RouteStudy, pictures: Sequence[SavedFigure], command: str, path: Path) -> None:
    """Write the report of a study with its pictures as an HTML page to `path`. Raises OSError.

    `command`: typed words, without those that belong to the machine alone.
    """
    plan = study.plan
    write_page(
        path,
        "kurt2rt.experiments.route",
        "report.html.j2",
        _TITLE,
        pictures,
        reasons=list(reasons_against_judging(plan.seeds)),
        seeds=spans(plan.seeds),
        tables=list(all_tables(study)),
        basic_s=plan.basic.teaching.duration_s,
        teaching_s=plan.task.teaching.duration_s,
        command=command,
        source=source_hash(),
    )
