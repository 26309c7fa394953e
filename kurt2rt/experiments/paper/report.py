"""One HTML file that holds everything: tables, figures, settings, and how it was made."""

from collections.abc import Sequence
from pathlib import Path

from kurt2rt.experiments.paper.eligibility import reasons_not_to_judge
from kurt2rt.experiments.paper.settings_tables import SUCCESS, exams_table, learning_table
from kurt2rt.experiments.paper.summary import PaperStudy
from kurt2rt.experiments.paper.tables import all_tables, unseen_table
from kurt2rt.experiments.study.eligibility import ROBOTS
from kurt2rt.experiments.study.figure import SavedFigure
from kurt2rt.experiments.study.html_report import spans, write_page
from kurt2rt.experiments.study.provenance import source_hash

_TITLE = "KURT2: the paper's basic-level tasks, taught and examined"


def write_report(study: PaperStudy, pictures: Sequence[SavedFigure], command: str, path: Path) -> None:
    """Write the report of a study with its pictures as an HTML page to `path`. Raises OSError.

    `command`: typed words, without those that belong to the machine alone.
    """
    plan = study.plan
    write_page(
        path,
        "kurt2rt.experiments.paper",
        "report.html.j2",
        _TITLE,
        pictures,
        study=study,
        reasons=list(reasons_not_to_judge(plan)),
        extent=plan.extent,
        seeds=spans(plan.seeds),
        tables=list(all_tables(study)),
        unseen=[table for each in study.summaries if (table := unseen_table(each)).rows],
        robots=ROBOTS,
        settings=[learning_table(study), exams_table(study)],
        success=SUCCESS,
        command=command,
        source=source_hash(),
    )
